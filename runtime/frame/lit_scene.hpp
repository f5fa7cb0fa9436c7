// The scene as the lighting system sees it, gathered from the registry and what is resident: rigid groups as
// receivers and as bodies, the lights that stand among them, and by which carrier each group has each light:
// - the group's own column, where the light belongs to it and stands where it stood when that was baked;
// - per pixel with a shadow cube map, where the light stands within the bounds of a group of surfaces;
// - harmonics at the group's light samples otherwise.
// Never two of them, or the light would count twice.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/frame/world.hpp"
#include "runtime/lighting/incident_light.hpp"

namespace lambent::frame {

struct LitScene {
  std::vector<lighting::IncidentGroup> groups;  // in the order of residency().groups()
  std::vector<std::vector<glm::vec3>> lamps;    // per group, what its own lights give now, by light column
  std::vector<lighting::IncidentBody> bodies;
  std::vector<lighting::LocalLight> lights;
  std::vector<lighting::NearLight> near_lights;  // at most kMaxNearLights
  std::vector<std::uint32_t> near_masks;         // per group: bit k for near light k
  std::vector<std::size_t> near_sources;         // per near light: among the lights
  std::uint32_t near_left_out = 0;  // lights within bounds for which there was no place left: harmonics

  // Whether anything but the environment reaches any group from outside.
  bool needsSampling() const;
};

struct LitSceneOptions {
  bool near_lights = true;  // else all lights that stand in the scene go by harmonics
  bool bodies = true;       // else groups neither light nor shadow each other
};

// surroundings: mean radiance, by which bodies count as bright.
// radiance_drift of the bodies is for the frame to say.
LitScene gatherLitScene(const World& world, float surroundings, const LitSceneOptions& options = {});

// Whether a light that stands in the scene is within a group's bounds, which are in its frame.
bool standsWithin(const scene::Box& bounds, const glm::mat4& world_from_group,
                  const lighting::LocalLight& light);

// The proxies of the groups that have one, in the order of the bodies, and the ids of the groups.
struct BodyProxies {
  std::vector<const bundle::CaptureProxy*> proxies;
  std::vector<std::uint64_t> keys;
};
BodyProxies proxiesOf(const streaming::Residency& residency);

}  // namespace lambent::frame
