// What the surfaces of one rigid group send on of the light of lamps that stand among them. Each lamp is
// bounced once at unit power and kept until it, the group or what else stands in its light moves; so a lamp
// that is dimmed or takes another colour costs a sum, and the light of several is the sum of theirs. No GL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/lighting/near_light.hpp"
#include "runtime/lighting/patch_transport.hpp"

namespace lambent::frame {

class LampRoom {
 public:
  LampRoom() = default;
  explicit LampRoom(std::shared_ptr<const lighting::PatchTransport> transport)
      : transport_(std::move(transport)) {}

  // Null until it was made.
  const std::shared_ptr<const lighting::PatchTransport>& transport() const { return transport_; }

  // others: what else stands in the light, in the group's frame.
  void light(std::span<const lighting::NearLight> lamps, const glm::mat4& world_from_group,
             std::span<const lighting::RayTriangle> others);

  // Radiance of each patch: what it sends on of the lamps' light, after any number of bounces. Empty where no
  // lamp shines.
  const std::vector<glm::vec3>& givenOff() const { return given_off_; }
  // Rises when that is other than before.
  std::uint64_t version() const { return version_; }
  // By how much of itself it has changed so far, summed up.
  double drift() const { return drift_; }
  // Lamps that the last light() bounced anew.
  std::uint32_t bouncedLast() const { return bounced_; }

 private:
  struct Lamp {
    lighting::NearLight light;  // of power 1
    std::vector<glm::vec3> given_off;
  };
  std::shared_ptr<const lighting::PatchTransport> transport_;
  std::vector<Lamp> lamps_;
  std::vector<glm::vec3> powers_;
  glm::mat4 world_from_group_{1.0f};
  std::vector<lighting::RayTriangle> others_;
  std::vector<glm::vec3> given_off_;
  std::uint64_t version_ = 0;
  double drift_ = 0.0;
  std::uint32_t bounced_ = 0;
};

}  // namespace lambent::frame
