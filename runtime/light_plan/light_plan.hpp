// Decides, once per frame, which carrier brings each light to each rigid group, and gathers the scene as the
// lighting system sees it: groups as receivers and as bodies, lights, and which lights have shadow cubes. All
// passes read this table, and nothing else decides. Direct light is shadowed (per pixel, by maps) or carried
// by harmonics (at light probes, or by the columns of a group's transfer):
// - The group's own column carries the light if it belongs to the group and stands where it stood in the
//   bake. If its shape is known and a shadow cube is free, only its bounces go by the column.
// - A shadow cube, if the light stands within the bounds of a group of surfaces; patches bounce it.
// - A shadow cube, if the light stands beside any group, within a few of its radii. It then shines so on all
//   groups of surfaces, so that what stands between them casts each shadow once. Its bounces travel as
//   harmonics, kept apart as for key lights. Near the limit of that distance the light fades to the next
//   carrier.
// - A shadow map, if the light is directional and among the brightest of these (sunsOf): then it is a key
//   light of the environment and not in `lights`.
// - Harmonics at the group's light probes otherwise.
// Light and shadow of a body with a neighborhood grid reach a group by that grid or by captures
// (chooseGrids). Each path of light has exactly one carrier, or it would count twice. No GL; no errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "runtime/lighting/incident_light.hpp"
#include "runtime/lighting/local_light.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Names pairs of groups of the residency: a body, and a receiver that takes the body's light and shadow from
// its grid.
using GridPairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

struct LightPlan {
  std::vector<lighting::IncidentGroup> groups;  // in the order of residency().groups()
  std::vector<std::vector<glm::vec3>> lamps;    // per group, its own lights' strengths by column
  std::vector<std::vector<float>> lamps_apart;  // per group and column: share shaded per pixel, 0 or 1
  std::vector<lighting::IncidentBody> bodies;
  std::vector<lighting::LocalLight> lights;
  // At most kMaxShadowedLights, with their power times the share shaded per pixel. Column lights come last.
  std::vector<lighting::LocalLight> shadowed_lights;
  // For each of these, the entity of an emissive material whose own surfaces it does not light, or null.
  std::vector<ecs::Entity> own_lamps;
  // Per group, bit k for shadowed light k: it shines on the group per pixel; it does so from within its
  // bounds, so that patches bounce it; from beside, so that harmonics do. Columns bounce the rest.
  std::vector<std::uint32_t> pixel_masks, within_masks, beside_masks;
  std::vector<bool> material_cubes;          // per group: an emissive material of its columns has a cube
  std::vector<ecs::Entity> column_entities;  // of the column lights that have cubes
  GridPairs grid_pairs;                      // which grids carry
  std::uint32_t grids_ready = 0;             // grids that may carry
  std::uint32_t local_left_out = 0;  // lights within bounds without a free shadow cube: harmonics carry them

  // Returns whether anything but the environment reaches any group from outside.
  bool needsSampling() const;
};

// Holds the grids that bodies have, for the choice between them and captures.
struct PlannedGrids {
  std::span<const effects::neighborhood::Grid> grids{};
  const GridPairs* before = nullptr;  // the pairs of the step before; not null if there are grids
  bool on = false;                    // false: captures carry all pairs
  bool fades = false;                 // a change of carriers results from motion, so it fades
};

struct LightPlanOptions {
  bool shadowed_lights = true;  // false: harmonics carry all lights that stand in the scene
  bool column_lights = false;   // true: column lights are shaded per pixel where shadow cubes are free
  float local_radii = 0.0f;     // lights within this many radii of a group's centre are beside it
  bool bodies = true;           // false: groups neither light nor shadow each other
  std::uint32_t most_suns = 0;  // as for sunsOf()
  // Column lights that had cubes in the step before.
  std::span<const ecs::Entity> cubes_before{};
  PlannedGrids grids{};
};

// Lists the brightest directional lights of the world, at most so many, in the order of their entities.
struct Suns {
  std::vector<ecs::Entity> entities;
  std::vector<spec::Disc> discs;  // in world axes; far smaller than the sun, as the lights are parallel
};
Suns sunsOf(const World& world, std::uint32_t most);

// Makes the plan. `surroundings` is the mean radiance against which bodies count as bright.
LightPlan makeLightPlan(const World& world, float surroundings, const LightPlanOptions& options = {});

// Chooses which lights in the scene are shaded per pixel with shadow cubes, and with what share: those within
// the bounds of a group, and those beside one, within a given number of its radii from its centre. Near that
// distance the share falls to 0 continuously. No GL.

// Returns whether a light in the scene is within a group's bounds, which are given in the group's frame.
bool standsWithin(const scene::Box& bounds, const glm::mat4& world_from_group,
                  const lighting::LocalLight& light);

// Returns the distance of such a light from the centre of a group's bounds in units of their radius: 0 within
// the bounds, larger outside, infinite if it is undefined.
float radiiFrom(const scene::Box& bounds, const glm::mat4& world_from_group,
                const lighting::LocalLight& light);

// Returns the share of each light, 0..1, given the least radiiFrom() over all groups. Lights within bounds
// have share 1. At most kMaxShadowedLights have a share: if more stand within `radii`, the distance of the
// first one without a cube becomes the limit, so that nothing jumps when two lights change places.
std::vector<float> localShares(std::span<const float> radii_from, float radii);

// Chooses which of the groups' own lights are shaded per pixel: column lights whose shape is known, as far as
// there are shadow cubes. Point and spot lights at nodes, and emissive materials that shine as a few spheres,
// have a known shape. All other column lights, and those without a cube, shine by their columns alone. No GL.

// Describes a column light that a shadow cube, or one for each of its spheres, can show.
struct ColumnLight {
  std::size_t group = 0;  // of the residency
  std::uint32_t column = 0;
  bool material = false;
  ecs::Entity entity{};  // of the light, or of the lamp of the material
  std::vector<lighting::LocalLight> shapes;
};

// Returns the column lights of all groups of surfaces that shine now, stand in their places and have a known
// shape. A group that was scaled since the bake has none, because its columns do not know of that.
std::vector<ColumnLight> findColumnLights(const World& world);

// Returns the intensity of a light, as luminance in candela.
float intensityOf(const lighting::LocalLight& light);

// Returns about what each light brings to the picture: its mean irradiance over what the camera sees of the
// bounds of its group, as if nothing was in the way. Without a camera it is the light's intensity.
std::vector<float> effectsOf(const World& world, std::span<const ColumnLight> lights);

// Returns the indices, rising, of those lights that get shadow cubes, of which `cubes` are free: those with
// the greatest effect, each only if there are cubes for all of its shapes. A light whose entity is in
// `before` keeps its cubes until another one is clearly greater.
std::vector<std::size_t> chooseColumnLights(std::span<const ColumnLight> lights,
                                            std::span<const float> effects, std::size_t cubes,
                                            std::span<const ecs::Entity> before = {});

}  // namespace lambent::frame
