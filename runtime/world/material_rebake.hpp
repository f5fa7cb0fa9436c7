// Finds which changes of a material do not show, or show only approximately, before a rebake: bounced light
// carries the baked colours, and surfaces baked as diffuse cannot have highlights. It takes the material as
// it is now and as it was baked, and how the bundle uses it. It returns a sentence for each such change; if
// there is none, the picture is what a rebake would give, up to the coding of transfer. Pure functions, any
// thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/bundle/description.hpp"

namespace lambent::frame {

// Describes how the draws of a bundle use one of its materials.
struct MaterialUse {
  bool diffuse = false, normal_mapped = false, glossy = false;  // which kinds of draws use it
  bool layered = false;                      // draws have a specular layer over diffuse transfer
  bool bounces = false;                      // baked transfer contains light reflected by it
  bool seen = false;                         // other groups see it
  bool lamp = false;                         // its emission is baked as a light of its group
  std::vector<bundle::BrdfFamily> tables{};  // those in the bundle
};
MaterialUse materialUse(const bundle::Description& description, std::uint32_t material);

struct RebakeReason {
  std::string field;     // field of the MaterialComponent
  std::string sentence;  // a message for the user
  bool shows = false;    // true: shows approximately before a rebake; false: not at all
};
std::vector<RebakeReason> needsRebake(const gltf::Material& now, const gltf::Material& baked,
                                      const MaterialUse& use);

}  // namespace lambent::frame
