// What the surfaces of one rigid group send on of lamps that stand among them and of key lights, by patches.
// Each light is bounced once at unit power and kept until it, the group or what else stands in its light
// moves; so a light that is dimmed or takes another colour costs a sum, and the light of several is the sum
// of theirs. Of key lights the group's transfer brings bounced light already, as far as few bands know where
// they fall. So what the bands say is taken off here: patches carry the difference between a key light with
// its shadows and its bands, and the detail of transfer stays. No GL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/lighting/patch_transport.hpp"
#include "runtime/lighting/shadowed_light.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent::frame {

// Bands of the key lights at one light probe: what transfer takes for them. Group frame.
struct KeyBands {
  glm::vec3 position{0.0f};
  std::vector<glm::vec4> light;  // at least order² coefficients of the transport
  bool operator==(const KeyBands&) const = default;
};

struct RoomLights {
  std::vector<lighting::ShadowedLight> lamps{};  // world
  std::vector<spec::Disc> keys{};                // directions in the group's frame
  std::vector<KeyBands> bands{};                 // one at least where there are keys
  bool none() const { return lamps.empty() && keys.empty(); }
};

class PatchRoom {
 public:
  PatchRoom() = default;
  explicit PatchRoom(std::shared_ptr<const lighting::PatchTransport> transport)
      : transport_(std::move(transport)) {}

  // Null until it was made.
  const std::shared_ptr<const lighting::PatchTransport>& transport() const { return transport_; }

  // others: what else stands in the light, in the group's frame.
  void light(const RoomLights& lights, const glm::mat4& world_from_group,
             std::span<const lighting::RayTriangle> others);

  // Radiance of each patch: what it sends on of the lights, after any number of bounces; of key lights more
  // or less than their bands say, so also below 0. Empty where no light shines.
  const std::vector<glm::vec3>& givenOff() const { return given_off_; }
  // Rises when that is other than before.
  std::uint64_t version() const { return version_; }
  // By how much of itself it has changed so far, summed up.
  double drift() const { return drift_; }
  // Lights that the last light() bounced anew.
  std::uint32_t bouncedLast() const { return bounced_; }

 private:
  struct Source {
    std::variant<lighting::ShadowedLight, spec::Disc> light;  // of power 1
    std::vector<glm::vec3> given_off;
  };
  // Those that are not among the kept ones are bounced.
  std::vector<Source> bounceAll(const RoomLights& lights, const std::vector<Source>& kept);
  std::vector<glm::vec3> bandsOnPatches(const std::vector<KeyBands>& bands) const;

  std::shared_ptr<const lighting::PatchTransport> transport_;
  std::vector<Source> sources_;
  std::vector<glm::vec3> powers_;
  std::vector<KeyBands> bands_;
  std::vector<glm::vec3> by_bands_;  // what patches give off of these
  glm::mat4 world_from_group_{1.0f};
  std::vector<lighting::RayTriangle> others_;
  std::vector<glm::vec3> given_off_;
  std::uint64_t version_ = 0;
  double drift_ = 0.0;
  std::uint32_t bounced_ = 0;
};

}  // namespace lambent::frame
