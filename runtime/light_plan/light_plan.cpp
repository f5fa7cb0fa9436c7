#include "runtime/light_plan/light_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <glm/matrix.hpp>

#include "runtime/lighting/key_lights.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::frame {

namespace {

// At this angular radius a penumbra is narrower than a texel of the finest shadow map.
constexpr float kSunRadius_rad = 1e-4f;

// A body brighter than its surroundings by this factor is drawn however small it is.
constexpr float kMaxBrightness = 1e6f;

lighting::LocalLight describe(const ecs::Registry& registry, ecs::Entity entity,
                              const scene::LocalLightComponent& light) {
  const auto* place = registry.tryGet<scene::WorldTransform>(entity);
  const glm::mat4 world_from_node = place ? place->world_from_node : glm::mat4(1.0f);
  lighting::LocalLight described{.kind = light.kind,
                                 .position_ws = glm::vec3(world_from_node[3]),
                                 .direction_ws = lighting::shiningAlong(world_from_node),
                                 .radius_m = light.radius_m,
                                 .power = light.power(),
                                 .range_m = light.range_m,
                                 .inner_cone_rad = light.inner_cone_rad,
                                 .outer_cone_rad = light.outer_cone_rad};
  if (!hasExtent(described)) described.radius_m = 0.0f;
  return described;
}

// Returns the largest radiance that a triangle of the proxy emits.
float peakEmission(const bundle::CaptureProxy& proxy, const std::vector<glm::vec3>& lamps) {
  float peak = 0.0f;
  for (const bundle::ProxyTriangle& triangle : proxy.triangles) {
    if (triangle.light < 0) continue;
    const glm::vec3 radiance = triangle.emission * lamps[static_cast<std::size_t>(triangle.light)];
    peak = std::max({peak, radiance.r, radiance.g, radiance.b});
  }
  return peak;
}

using Path = lighting::LightCarrier::Path;

// Lists the lights that are no suns, and returns their entities.
std::vector<ecs::Entity> gatherLights(const World& world, std::uint32_t most_suns, LightPlan& plan) {
  const Suns suns = sunsOf(world, most_suns);
  std::vector<ecs::Entity> entities;
  for (auto [entity, light] : world.registry().view<const scene::LocalLightComponent>()) {
    if (light.power() == glm::vec3(0.0f) || std::ranges::find(suns.entities, entity) != suns.entities.end())
      continue;
    plan.lights.push_back(describe(world.registry(), entity, light));
    entities.push_back(entity);
  }
  return entities;
}

// Adds the group as a receiver, whose lights come by columns or harmonics as yet, and as a body.
void addGroup(const World& world, std::size_t index, float surroundings, bool bodies,
              std::span<const ecs::Entity> light_entities, LightPlan& plan) {
  const streaming::ResidentGroup& group = world.residency().groups()[index];
  const glm::mat4 world_from_group = world.worldFromGroup(index);
  const std::vector<glm::vec3>& lamps = plan.lamps.emplace_back(world.lampsOf(index));
  lighting::IncidentGroup& receiver = plan.groups.emplace_back();
  receiver.key = world.keyOf(index);
  receiver.samples = group.id;
  for (const glm::vec3& sample : group.light_probes)
    receiver.samples_ws.emplace_back(world_from_group * glm::vec4(sample, 1.0f));
  for (const ecs::Entity light : light_entities)
    receiver.carriers.push_back({.path = world.litByColumn(index, light) ? Path::Column : Path::Harmonics});
  if (!group.proxy || !bodies) return;
  receiver.body = static_cast<std::uint32_t>(plan.bodies.size());
  const scene::Box& bounds = world.groupBounds(index);
  const glm::vec3 center = bounds.empty() ? glm::vec3(0.0f) : bounds.center();
  const float peak = group.light_columns > 0 ? peakEmission(*group.proxy, lamps) : 0.0f;
  const float brightness = surroundings > 0.0f ? peak / surroundings : kMaxBrightness * peak;
  plan.bodies.push_back({.body = {.proxy = receiver.body,
                                  .world_from_proxy = world_from_group,
                                  .brightness = std::clamp(brightness, 1.0f, kMaxBrightness)},
                         .center_ws = glm::vec3(world_from_group * glm::vec4(center, 1.0f)),
                         .radius_m = bounds.radius() * scene::largestScale(world_from_group),
                         .key = receiver.key});
}

// Returns the least distance, in radii, of each light from any group of surfaces that has no column for it.
std::vector<float> nearnessOf(const World& world, const LightPlan& plan) {
  std::vector<float> nearness(plan.lights.size(), std::numeric_limits<float>::infinity());
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    if (world.residency().groups()[g].volume >= 0) continue;
    for (std::size_t k = 0; k < plan.lights.size(); ++k)
      if (shines(plan.lights[k]) && plan.groups[g].carriers[k].path != Path::Column)
        nearness[k] =
            std::min(nearness[k], radiiFrom(world.groupBounds(g), world.worldFromGroup(g), plan.lights[k]));
  }
  return nearness;
}

// Gives shadow cubes to lights with a share, and returns which each has, or -1.
std::vector<std::int32_t> giveCubes(std::span<const float> shares, LightPlan& plan) {
  std::vector<std::int32_t> cubes(shares.size(), -1);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    if (shares[k] <= 0.0f) continue;
    cubes[k] = static_cast<std::int32_t>(plan.shadowed_lights.size());
    plan.shadowed_lights.push_back(plan.lights[k]);
    plan.shadowed_lights.back().power *= shares[k];
  }
  plan.own_lamps.resize(plan.shadowed_lights.size());
  return cubes;
}

// Gives the free shadow cubes to column lights.
void giveColumnCubes(const World& world, std::span<const ecs::Entity> light_entities,
                     std::span<const ecs::Entity> before, LightPlan& plan) {
  const std::vector<ColumnLight> lights = findColumnLights(world);
  const std::size_t free = lighting::kMaxShadowedLights - plan.shadowed_lights.size();
  for (const std::size_t i : chooseColumnLights(lights, effectsOf(world, lights), free, before)) {
    const ColumnLight& light = lights[i];
    plan.column_entities.push_back(light.entity);
    std::vector<float>& apart = plan.lamps_apart[light.group];
    apart.resize(world.residency().groups()[light.group].light_columns, 0.0f);
    apart[light.column] = 1.0f;
    if (light.material) plan.material_cubes[light.group] = true;
    for (std::size_t k = 0; k < light_entities.size() && !light.material; ++k)
      if (light_entities[k] == light.entity) plan.groups[light.group].carriers[k].path = Path::ColumnAndCube;
    for (const lighting::LocalLight& shape : light.shapes) {
      plan.pixel_masks[light.group] |= 1u << plan.shadowed_lights.size();
      plan.shadowed_lights.push_back(shape);
      plan.own_lamps.push_back(light.material ? light.entity : ecs::Entity{});
    }
  }
}

// Returns whether the group stands within a group that has a column for this light, or between that group and
// the light, and has a neighborhood grid through which the other takes the light. Then the grid must be
// multiplied with this light, unless a shadow cube brings the light to the other.
bool shadesColumn(const World& world, const LightPlan& plan, std::size_t group, std::size_t light) {
  const auto& groups = world.residency().groups();
  if (!world.describedGroup(group).neighborhood) return false;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (g == group || groups[g].volume >= 0 || plan.groups[g].carriers[light].path != Path::Column) continue;
    scene::Box lit = world.groupBounds(g);
    lit.add(
        glm::vec3(glm::inverse(world.worldFromGroup(g)) * glm::vec4(plan.lights[light].position_ws, 1.0f)));
    if (meet(world.groupBounds(group), world.worldFromGroup(group), lit, world.worldFromGroup(g)))
      return true;
  }
  return false;
}

// Decides which lights shine on the group from within its bounds or from beside it.
void choosePaths(const World& world, std::size_t group, std::span<const float> shares,
                 std::span<const std::int32_t> cubes, float local_radii, LightPlan& plan) {
  for (std::size_t k = 0; k < plan.lights.size(); ++k) {
    lighting::LightCarrier& carrier = plan.groups[group].carriers[k];
    if (carrier.path != Path::Harmonics) continue;
    const std::uint32_t bit = cubes[k] >= 0 ? 1u << cubes[k] : 0u;
    if (radiiFrom(world.groupBounds(group), world.worldFromGroup(group), plan.lights[k]) == 0.0f) {
      plan.within_masks[group] |= bit;
      if (bit != 0)
        carrier.path = Path::Cube;
      else
        ++plan.local_left_out;
    } else if (bit != 0 && local_radii > 0.0f && !shadesColumn(world, plan, group, k)) {
      plan.beside_masks[group] |= bit;
      carrier.per_pixel = shares[k];
    }
  }
  plan.pixel_masks[group] |= plan.within_masks[group] | plan.beside_masks[group];
}

// Returns the box of the grid's points. If `grown` is set, it is larger by the distance of two points on each
// side.
scene::Box boxOf(const bundle::NeighborhoodGrid& grid, bool grown) {
  const glm::vec3 margin =
      grown ? (grid.bounds_max - grid.bounds_min) / glm::vec3(grid.size - 1u) : glm::vec3(0.0f);
  return {grid.bounds_min - margin, grid.bounds_max + margin};
}

bool hasSurfaces(const bundle::Group& group) {
  return !group.volume && std::ranges::any_of(group.cells, [](const bundle::Cell& cell) {
    return cell.domain == transfer::Domain::Vertex;
  });
}

// Returns whether the grid also carries the light of the group's own lamps, if it has any.
bool carriesLamps(const bundle::Group& group) {
  return group.lights.empty() || std::ranges::all_of(group.cells, [](const bundle::Cell& cell) {
           return cell.domain != transfer::Domain::GridPoint ||
                  std::ranges::any_of(cell.transfers, [](const bundle::CellTransfer& part) {
                    return !part.fromEnvironment();
                  });
         });
}

// Returns whether the body's shadow in the light of lamps would reach the receiver twice, by grid and by
// shadow cube, or not at all. Volumes stand in no shadow cube.
bool localShadowsDiffer(const LightPlan& plan, std::size_t body, std::size_t receiver) {
  // The receiver may have a column light by a cube. If that is a material, the body takes it as light of
  // another body, so its grid always has it.
  if (plan.material_cubes[receiver]) return true;
  // Returns the share of direct light that comes by harmonics, or nothing if a column carries it.
  const auto byHarmonics = [](const lighting::LightCarrier& carrier) -> std::optional<float> {
    if (carrier.path == Path::Harmonics) return 1.0f - carrier.per_pixel;
    return carrier.path == Path::Cube ? std::optional(0.0f) : std::nullopt;
  };
  for (std::size_t k = 0; k < plan.lights.size(); ++k) {
    const std::optional<float> sent = byHarmonics(plan.groups[body].carriers[k]);
    std::optional<float> had = byHarmonics(plan.groups[receiver].carriers[k]);
    if (plan.groups[receiver].carriers[k].path == Path::ColumnAndCube) had = 0.0f;
    if (sent && had && *sent != *had) return true;
  }
  return false;
}

// Chooses for each ordered pair (body k, receiving group B) whether the grid of k is its carrier, and leaves
// k out of B's captures then. It is if all of these conditions hold:
// - The grid has arrived.
// - B has surfaces and is another group than k.
// - B's bounds meet the grid's box. Once the grid carries the pair, B's bounds need only meet the box grown
//   by the distance of two points on every side, so that the carrier does not alternate.
// - k has no lamps of its own, or its grid carries them.
// - k is a volume, or the share of every local light that shadow cubes carry is the same for k and B.
//   Otherwise k's shadow, which the cubes contain, would count twice or not at all.
// The grid of a volume acts on every group with surfaces, including the one that the volume stands within.
void chooseGrids(const World& world, const PlannedGrids& grids, LightPlan& plan) {
  for (lighting::IncidentGroup& group : plan.groups) group.fades = grids.fades;
  for (const effects::neighborhood::Grid& grid : grids.grids) {
    if (!grid.ready || !carriesLamps(world.describedGroup(grid.group))) continue;
    ++plan.grids_ready;
    if (!grids.on) continue;
    const glm::mat4 world_from_body = world.worldFromGroup(grid.group);
    for (std::uint32_t b = 0; b < plan.groups.size(); ++b) {
      const bool before = grids.before->contains({grid.group, b});
      if (b == grid.group || !hasSurfaces(world.describedGroup(b)) ||
          !meet(boxOf(grid.points, before), world_from_body, world.groupBounds(b), world.worldFromGroup(b)) ||
          (world.residency().groups()[grid.group].volume < 0 && localShadowsDiffer(plan, grid.group, b)))
        continue;
      plan.grid_pairs.insert({grid.group, b});
      std::vector<std::uint32_t>& left_out = plan.groups[b].left_out;
      const std::uint32_t body = plan.groups[grid.group].body;
      if (body != lighting::CapturePoint::kNoBody && !std::ranges::binary_search(left_out, body))
        left_out.insert(std::ranges::upper_bound(left_out, body), body);
    }
  }
}

}  // namespace

bool LightPlan::needsSampling() const {
  const auto seesOthers = [&](const lighting::IncidentGroup& group) {
    const std::size_t own = group.body == lighting::CapturePoint::kNoBody ? 0 : 1;
    return bodies.size() > own + group.left_out.size();
  };
  return !lights.empty() || std::ranges::any_of(groups, seesOthers);
}

Suns sunsOf(const World& world, std::uint32_t most) {
  const ecs::Registry& registry = world.registry();
  struct Sun {
    ecs::Entity entity;
    lighting::LocalLight light;
    std::size_t place;
  };
  std::vector<Sun> suns;
  for (auto [entity, light] : registry.view<const scene::LocalLightComponent>())
    if (light.kind == scene::LocalLightComponent::Kind::Directional && light.power() != glm::vec3(0.0f))
      suns.push_back({entity, describe(registry, entity, light), suns.size()});
  if (suns.size() > most) {
    std::ranges::stable_sort(suns, std::ranges::greater{},
                             [](const Sun& sun) { return lighting::luminance(sun.light.power); });
    suns.resize(most);
    std::ranges::sort(suns, {}, &Sun::place);
  }
  Suns found;
  const float sine = std::sin(kSunRadius_rad);
  for (const Sun& sun : suns) {
    found.entities.push_back(sun.entity);
    // A disc of radiance L gives the irradiance π sin² r L to a surface that faces it.
    found.discs.push_back({.direction = -sun.light.direction_ws,
                           .radius_rad = kSunRadius_rad,
                           .radiance = sun.light.power / (std::numbers::pi_v<float> * sine * sine)});
  }
  return found;
}

LightPlan makeLightPlan(const World& world, float surroundings, const LightPlanOptions& options) {
  LightPlan plan;
  const auto& groups = world.residency().groups();
  const std::vector<ecs::Entity> light_entities = gatherLights(world, options.most_suns, plan);
  for (std::size_t g = 0; g < groups.size(); ++g)
    addGroup(world, g, surroundings, options.bodies, light_entities, plan);
  for (std::vector<std::uint32_t>* masks : {&plan.pixel_masks, &plan.within_masks, &plan.beside_masks})
    masks->resize(groups.size());
  plan.lamps_apart.resize(groups.size());
  plan.material_cubes.resize(groups.size());

  std::vector<float> shares(plan.lights.size(), 0.0f);
  if (options.shadowed_lights) shares = localShares(nearnessOf(world, plan), options.local_radii);
  const std::vector<std::int32_t> cubes = giveCubes(shares, plan);
  if (options.column_lights) giveColumnCubes(world, light_entities, options.cubes_before, plan);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    // Rays through a volume look up only its samples, not shadow cubes.
    if (options.shadowed_lights && groups[g].volume < 0)
      choosePaths(world, g, shares, cubes, options.local_radii, plan);
    // The transfer of a volume contains what it stands within.
    const std::int32_t within = world.describedGroup(g).within;
    if (within < 0) continue;
    const std::size_t around =
        world.residency().bundles()[groups[g].bundle].first.groups + static_cast<std::size_t>(within);
    if (const std::uint32_t body = plan.groups[around].body; body != lighting::CapturePoint::kNoBody)
      plan.groups[g].left_out.push_back(body);
  }
  chooseGrids(world, options.grids, plan);
  return plan;
}

}  // namespace lambent::frame
