// Gathers the scene as the lighting system sees it, from the registry and what is resident: rigid groups as
// receivers and as bodies, the local lights, and which carrier brings each light to each group:
// - the group's own light column, if the light belongs to the group and stands where it stood in the bake. If
//   its shape is known and a shadow cube is free, only its bounces go by the column, and its direct light
//   goes per pixel (shadowed_light_choice.hpp);
// - a shadow cube map, per pixel, if the light stands within the bounds of a group of surfaces; its bounces
//   travel by patches;
// - a shadow cube map, per pixel, if the light stands beside any group, within a few of its radii. It then
//   shines so on all groups of surfaces, so that what stands between them casts each shadow once, and its
//   bounces travel as harmonics at the light probes, kept apart as for key lights. Near the limit of that
//   distance the light fades to the next carrier;
// - a shadow map, per pixel, if the light is directional and among the brightest of these (sunsOf): then it
// is
//   a key light of the environment and not in `lights`;
// - harmonics at the group's light probes otherwise.
// Each path of light has exactly one carrier, or it would count twice. Render thread; no errors.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/incident_light.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Names the column light that a shadowed light shows.
struct ColumnCube {
  std::uint32_t shadowed_light = 0;
  std::size_t group = 0;  // of the column
  // Index in LitScene::lights of a light at a node; nothing for an emissive material.
  std::optional<std::size_t> source;
};

struct LitScene {
  std::vector<lighting::IncidentGroup> groups;  // in the order of residency().groups()
  std::vector<std::vector<glm::vec3>> lamps;    // per group, its own lights' strengths by column
  std::vector<std::vector<float>> lamps_apart;  // per group and column: share shaded per pixel, 0 or 1
  std::vector<lighting::IncidentBody> bodies;
  std::vector<lighting::LocalLight> lights;
  std::vector<lighting::ShadowedLight>
      shadowed_lights;                     // at most kMaxShadowedLights, times the share shaded per pixel
  std::vector<std::uint32_t> local_masks;  // per group: bit k if shadowed light k stands within its bounds
  std::vector<std::uint32_t> pixel_masks;  // per group: bit k if shadowed light k shines on it per pixel
  // Column lights come after the other shadowed lights, and each shines so on the group of its column only.
  std::vector<ColumnCube> column_cubes;
  std::vector<ecs::Entity> column_entities;  // of these lights
  std::vector<std::size_t> local_sources;  // for each shadowed light that is no column, its index in `lights`
  // For each shadowed light, the entity of an emissive material whose own surfaces it does not light, or
  // null.
  std::vector<ecs::Entity> own_lamps;
  std::uint32_t local_left_out = 0;  // lights within bounds without a free shadow cube: harmonics carry them

  // Returns whether anything but the environment reaches any group from outside.
  bool needsSampling() const;
  // Returns bit k if shadowed light k is a column of the group.
  std::uint32_t columnMask(std::size_t group) const;
};

struct LitSceneOptions {
  bool shadowed_lights = true;  // false: harmonics carry all lights that stand in the scene
  bool column_lights = false;   // true: column lights are shaded per pixel where shadow cubes are free
  float local_radii = 0.0f;     // lights within this many radii of a group's centre are beside it
  bool bodies = true;           // false: groups neither light nor shadow each other
  std::uint32_t most_suns = 0;  // as for sunsOf()
  // Column lights that had cubes in the step before.
  std::span<const ecs::Entity> cubes_before{};
};

// Lists the brightest directional lights of the world, at most so many, in the order of their entities.
struct Suns {
  std::vector<ecs::Entity> entities;
  std::vector<spec::Disc> discs;  // in world axes; far smaller than the sun, as the lights are parallel
};
Suns sunsOf(const World& world, std::uint32_t most);

// Gathers the scene. `surroundings` is the mean radiance against which bodies count as bright. The frame
// fills in radiance_drift of the bodies.
LitScene gatherLitScene(const World& world, float surroundings, const LitSceneOptions& options = {});

// Lists the proxies of the groups that have one, in the order of the bodies, and the keys of these groups.
struct BodyProxies {
  std::vector<const bundle::CaptureProxy*> proxies;
  std::vector<std::uint64_t> keys;
};
BodyProxies proxiesOf(const streaming::Residency& residency);

// Finds what bodies hide of lamps that are shaded per pixel, when these bodies reach a group by their
// neighborhood grids and are left out of its captures. Shadow cubes occlude the direct light of such lamps;
// this gives the occlusion for their bounced light. It traces rays from the light probes to the lamps among
// the bodies' proxies, where anything of this has moved since the last step. No GL.
class ApartOcclusion {
 public:
  // Fills IncidentGroup::open of all groups; their samples_ws and left_out must be final. `proxies` is
  // indexed by CaptureBody::proxy, and `version` changes when they do. Returns for how many light probes rays
  // were traced.
  std::size_t update(LitScene& scene, std::span<const bundle::CaptureProxy* const> proxies,
                     std::uint64_t version);

 private:
  struct Group {
    std::vector<glm::vec3> samples_ws;
    std::vector<float> apart;
    std::vector<std::uint32_t> left_out;
    bool operator==(const Group&) const = default;
  };
  struct Inputs {  // all that the shares depend on
    std::uint64_t version = 0;
    std::vector<Group> groups;  // empty for groups of which nothing is traced; if all are, so are the rest
    std::vector<lighting::LocalLight> lights;  // without their power
    std::vector<glm::mat4> bodies;             // world_from_proxy
    bool operator==(const Inputs&) const = default;
  };
  Inputs traced_;
  std::vector<std::vector<float>> open_;  // per group, as in IncidentGroup
};

}  // namespace lambent::frame
