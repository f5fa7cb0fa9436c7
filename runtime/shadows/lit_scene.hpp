// Gathers the scene as the lighting system sees it, from the registry and what is resident: rigid groups as
// receivers and as bodies, the local lights, and which carrier brings each light to each group:
// - the group's own light column, if the light belongs to the group and stands where it stood in the bake;
// - a shadow cube map, per pixel, if the light stands within the bounds of a group of surfaces; its bounces
//   travel by patches;
// - a shadow cube map, per pixel, if the light stands beside any group, within a few of its radii. It then
//   shines so on all groups of surfaces, so that what stands between them casts each shadow once, and its
//   bounces travel as harmonics at the light probes, kept apart as for key lights. Near the limit of that
//   distance the light fades to the next carrier;
// - harmonics at the group's light probes otherwise.
// Each path of light has exactly one carrier, or it would count twice. Render thread; no errors.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/lighting/incident_light.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct LitScene {
  std::vector<lighting::IncidentGroup> groups;  // in the order of residency().groups()
  std::vector<std::vector<glm::vec3>> lamps;    // per group, its own lights' strengths by column
  std::vector<lighting::IncidentBody> bodies;
  std::vector<lighting::LocalLight> lights;
  std::vector<lighting::ShadowedLight>
      shadowed_lights;                     // at most kMaxShadowedLights, times the share shaded per pixel
  std::vector<std::uint32_t> local_masks;  // per group: bit k if shadowed light k stands within its bounds
  std::vector<std::uint32_t> pixel_masks;  // per group: bit k if shadowed light k shines on it per pixel
  std::vector<std::size_t> local_sources;  // for each shadowed light, its index in `lights`
  std::uint32_t local_left_out = 0;  // lights within bounds without a free shadow cube: harmonics carry them

  // Returns whether anything but the environment reaches any group from outside.
  bool needsSampling() const;
};

struct LitSceneOptions {
  bool shadowed_lights = true;  // false: harmonics carry all lights that stand in the scene
  float local_radii = 0.0f;     // lights within this many radii of a group's centre are beside it
  bool bodies = true;           // false: groups neither light nor shadow each other
};

// Gathers the scene. `surroundings` is the mean radiance against which bodies count as bright. The frame
// fills in radiance_drift of the bodies.
LitScene gatherLitScene(const World& world, float surroundings, const LitSceneOptions& options = {});

// Lists the proxies of the groups that have one, in the order of the bodies, and the keys of these groups.
struct BodyProxies {
  std::vector<const bundle::CaptureProxy*> proxies;
  std::vector<std::uint64_t> keys;
};
BodyProxies proxiesOf(const streaming::Residency& residency);

}  // namespace lambent::frame
