// Owns the light that the surfaces of one rigid group reflect of lamps among them and of key lights, by
// patches. What each light brings to the patches is kept at unit power until it, the group or a blocker
// moves. All of it is bounced together, so dimming or colouring lights traces no ray. For key lights the
// group's transfer already carries bounced light, as far as a few bands know where they fall. What the bands
// say is therefore subtracted here: patches carry the difference between a key light with its shadows and its
// bands, and the detail of transfer is kept. No GL.
//
// Patches are coarse, and what they take away may be more than the light that transfer brings. Therefore they
// also say what they reflect of all light as the bands know it: where that is more than transfer knows of,
// the change is in proportion (shareOfChange in patch_change.glsl).
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/lighting/local_light.hpp"
#include "runtime/lighting/patch_transport.hpp"
#include "runtime/lighting/patches.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent::frame {

// Computes the light that falls directly on the patches of a rigid group from a local light or from key
// lights: the closed forms with which pixels are shaded (shadowed_light.hpp), times the share of the
// light that rays find visible. Blockers are the patches' own triangles and those of other bodies. It uses
// several threads; results do not depend on how many. No GL.

// Returns E/pi at each patch for unit power, averaged over the patch's points. `others` are further blockers
// in the group's frame.
std::vector<float> lampOnPatches(const lighting::ShadowedLight& light, const lighting::Patches& patches,
                                 std::span<const lighting::RayTriangle> others,
                                 const glm::mat4& world_from_group);

// Returns the same for discs at infinity of radiance 1: one list of all patches per disc. Directions are in
// the group's frame.
std::vector<std::vector<float>> keysOnPatches(std::span<const spec::Disc> keys,
                                              const lighting::Patches& patches,
                                              std::span<const lighting::RayTriangle> others);

// Holds the bands of the light at one light probe, as transfer uses them, in the group's frame. Each has at
// least as many coefficients as order² of the transport.
struct KeyBands {
  glm::vec3 position{0.0f};
  std::vector<glm::vec4> keys;  // of the key lights
  std::vector<glm::vec4> all;   // of all light, key lights included
  bool operator==(const KeyBands&) const = default;
};

struct RoomLights {
  std::vector<lighting::ShadowedLight> lamps{};  // world
  std::vector<spec::Disc> keys{};                // directions in the group's frame
  std::vector<KeyBands> bands{};                 // at least one if there are keys
  bool none() const { return lamps.empty() && keys.empty(); }
};

class PatchRoom {
 public:
  PatchRoom() = default;
  explicit PatchRoom(std::shared_ptr<const lighting::PatchTransport> transport)
      : transport_(std::move(transport)) {}

  // Returns null until the transport is made.
  const std::shared_ptr<const lighting::PatchTransport>& transport() const { return transport_; }

  // Bounces the lights. `others` are further blockers in the group's frame.
  void light(const RoomLights& lights, const glm::mat4& world_from_group,
             std::span<const lighting::RayTriangle> others);

  // Returns the exit radiance of each patch after any number of bounces. For key lights it is the difference
  // to their bands, so it may be below 0. Empty if no light shines.
  const std::vector<glm::vec3>& givenOff() const { return given_off_; }
  // Returns the exit radiance of each patch by the bands of all light. Empty if there are no key lights.
  const std::vector<glm::vec3>& givenOffByBands() const { return given_off_by_bands_; }
  // Returns whether lamps are among its lights.
  bool hasLamps() const {
    return std::ranges::any_of(sources_, [](const Source& source) { return source.light.index() == 0; });
  }
  // Rises when one of these changes.
  std::uint64_t version() const { return version_; }
  // Returns the sum of all relative changes of givenOff() so far.
  double drift() const { return drift_; }
  // Returns for how many lights the last light() traced rays.
  std::uint32_t tracedLast() const { return traced_; }

 private:
  struct Source {
    std::variant<lighting::ShadowedLight, spec::Disc> light;  // at unit power
    std::vector<float> direct;                                // E/pi of each patch
  };
  // Traces rays for the lights that are not in `kept`.
  std::vector<Source> shineAll(const RoomLights& lights, const std::vector<Source>& kept);
  std::vector<glm::vec3> bandsOnPatches(std::vector<glm::vec4> KeyBands::*light) const;

  std::shared_ptr<const lighting::PatchTransport> transport_;
  std::vector<Source> sources_;
  std::vector<glm::vec3> powers_;
  std::vector<KeyBands> bands_;
  std::vector<glm::vec3> keys_by_bands_;  // E/pi of the patches due to these
  glm::mat4 world_from_group_{1.0f};
  std::vector<lighting::RayTriangle> others_;
  std::vector<glm::vec3> given_off_, given_off_by_bands_;
  std::uint64_t version_ = 0;
  double drift_ = 0.0;
  std::uint32_t traced_ = 0;
};

}  // namespace lambent::frame
