// What of a changed material does not show before it is baked again, or shows only nearly: light that bounced
// carries the colours that were baked, surfaces baked as diffuse cannot shine. Comes in: the material as it
// is and as it was baked, and how the bundle uses it. Goes out: a sentence for each such thing; none: the
// picture is what a rebake would give, up to the coding of transfer. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/bundle/description.hpp"

namespace lambent::frame {

// How the draws of a bundle use one of its materials.
struct MaterialUse {
  bool matte = false, normal_mapped = false, glossy = false;  // kinds of its draws
  bool bounces = false;                      // light from it is in the transfer of something that was baked
  bool seen = false;                         // other groups see it
  bool lamp = false;                         // what it gives off is baked as a light of its group
  std::vector<bundle::BrdfFamily> tables{};  // of the bundle
};
MaterialUse materialUse(const bundle::Description& description, std::uint32_t material);

struct RebakeReason {
  std::string field;     // of the MaterialComponent
  std::string sentence;  // for people
  bool shows = false;    // nearly; else not at all before a rebake
};
std::vector<RebakeReason> needsRebake(const gltf::Material& now, const gltf::Material& baked,
                                      const MaterialUse& use);

}  // namespace lambent::frame
