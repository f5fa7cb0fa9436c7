// The scene as the lighting system sees it, gathered from the registry and what is resident: rigid groups as
// receivers and as bodies, the lights that stand among them, and by which carrier each group has each light:
// - the group's own column, where the light belongs to it and stands where it stood when that was baked;
// - per pixel with a shadow cube map, where the light stands within the bounds of a group of surfaces; what
//   its surfaces send on comes by patches;
// - per pixel likewise, where the light stands beside any group, within some of its radii: then on all groups
//   of surfaces, so that what stands between them casts shadows once; what surfaces send on goes by harmonics
//   at the group's light probes, apart, as key lights do. On its way out of that distance the light goes
//   over to the next carrier bit by bit;
// - harmonics at the group's light probes otherwise.
// Of each path of light exactly one, or it would count twice.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/lighting/incident_light.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct LitScene {
  std::vector<lighting::IncidentGroup> groups;  // in the order of residency().groups()
  std::vector<std::vector<glm::vec3>> lamps;    // per group, what its own lights give now, by light column
  std::vector<lighting::IncidentBody> bodies;
  std::vector<lighting::LocalLight> lights;
  std::vector<lighting::ShadowedLight>
      shadowed_lights;                     // at most kMaxShadowedLights, as strong as they shine per pixel
  std::vector<std::uint32_t> local_masks;  // per group: bit k if local light k stands within its bounds
  std::vector<std::uint32_t> pixel_masks;  // per group: bit k if local light k shines on it per pixel
  std::vector<std::size_t> local_sources;  // per local light: among the lights
  std::uint32_t local_left_out = 0;  // lights within bounds for which there was no place left: harmonics

  // Whether anything but the environment reaches any group from outside.
  bool needsSampling() const;
};

struct LitSceneOptions {
  bool shadowed_lights = true;  // else all lights that stand in the scene go by harmonics
  float local_radii = 0.0f;     // lights nearer to a group's middle than so many of its radii stand beside it
  bool bodies = true;           // else groups neither light nor shadow each other
};

// surroundings: mean radiance, by which bodies count as bright.
// radiance_drift of the bodies is for the frame to say.
LitScene gatherLitScene(const World& world, float surroundings, const LitSceneOptions& options = {});

// The proxies of the groups that have one, in the order of the bodies, and the ids of the groups.
struct BodyProxies {
  std::vector<const bundle::CaptureProxy*> proxies;
  std::vector<std::uint64_t> keys;
};
BodyProxies proxiesOf(const streaming::Residency& residency);

}  // namespace lambent::frame
