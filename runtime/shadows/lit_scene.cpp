#include "runtime/shadows/lit_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "runtime/lighting/capture_queries.hpp"
#include "runtime/lighting/light_pieces.hpp"
#include "runtime/lighting/triangle_tree.hpp"
#include "runtime/scene/transforms.hpp"
#include "runtime/shadows/shadowed_light.hpp"
#include "runtime/shadows/shadowed_light_choice.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

namespace {

// At this angular radius a penumbra is narrower than a texel of the finest shadow map.
constexpr float kSunRadius_rad = 1e-4f;

// A body brighter than its surroundings by this factor is drawn however small it is.
constexpr float kMaxBrightness = 1e6f;

lighting::LocalLight::Kind kindOf(scene::LocalLightComponent::Kind kind) {
  using From = scene::LocalLightComponent::Kind;
  using To = lighting::LocalLight::Kind;
  switch (kind) {
    case From::Point:
      return To::Point;
    case From::Spot:
      return To::Spot;
    case From::Directional:
      return To::Directional;
    case From::Sphere:
      return To::Sphere;
    case From::Disc:
      return To::Disc;
  }
  return To::Point;
}

lighting::LocalLight describe(const scene::LocalLightComponent& light, const glm::mat4& world_from_node) {
  const glm::vec3 ahead = -glm::vec3(world_from_node[2]);
  const float length = glm::length(ahead);
  return {.kind = kindOf(light.kind),
          .position_ws = glm::vec3(world_from_node[3]),
          .direction_ws = length > 0.0f ? ahead / length : glm::vec3(0.0f, 0.0f, -1.0f),
          .power = light.power(),
          .radius_m = light.radius_m,
          .range_m = light.range_m,
          .inner_cone_rad = light.inner_cone_rad,
          .outer_cone_rad = light.outer_cone_rad};
}

lighting::LocalLight describe(const ecs::Registry& registry, ecs::Entity entity,
                              const scene::LocalLightComponent& light) {
  const auto* place = registry.tryGet<scene::WorldTransform>(entity);
  return describe(light, place ? place->world_from_node : glm::mat4(1.0f));
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

// Returns the least distance, in radii, of each light from any group of surfaces that has no column for it.
std::vector<float> nearnessOf(const World& world, std::span<const lighting::LocalLight> lights,
                              std::span<const ecs::Entity> entities) {
  std::vector<float> nearness(lights.size(), std::numeric_limits<float>::infinity());
  const auto& groups = world.residency().groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].volume >= 0) continue;
    for (std::size_t k = 0; k < lights.size(); ++k)
      if (const auto near = lighting::shadowedLightOf(lights[k]);
          near && shines(*near) && !world.litByColumn(g, entities[k]))
        nearness[k] =
            std::min(nearness[k], radiiFrom(world.groupBounds(g), world.worldFromGroup(g), lights[k]));
  }
  return nearness;
}

// Returns whether the group stands within a group that has a column for this light, or between that group and
// the light, and has a neighborhood grid through which the other takes the light. Then the grid must be
// multiplied with this light, unless a shadow cube brings the light to the other.
bool shadesColumn(const World& world, const LitScene& scene, std::size_t group, ecs::Entity light,
                  std::size_t source) {
  const glm::vec3& light_ws = scene.lights[source].position_ws;
  const auto byCube = [&](std::size_t g) {
    return std::ranges::any_of(
        scene.column_cubes, [&](const ColumnCube& cube) { return cube.group == g && cube.source == source; });
  };
  const auto& groups = world.residency().groups();
  if (!world.description(groups[group].bundle).groups[groups[group].index.value].neighborhood) return false;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (g == group || groups[g].volume >= 0 || !world.litByColumn(g, light) || byCube(g)) continue;
    scene::Box lit = world.groupBounds(g);
    lit.add(glm::vec3(glm::inverse(world.worldFromGroup(g)) * glm::vec4(light_ws, 1.0f)));
    if (meet(world.groupBounds(group), world.worldFromGroup(group), lit, world.worldFromGroup(g)))
      return true;
  }
  return false;
}

// Gives the free shadow cubes to column lights.
void addColumnLights(const World& world, std::span<const ecs::Entity> light_entities,
                     std::span<const ecs::Entity> before, LitScene& scene) {
  const std::vector<ColumnLight> lights = findColumnLights(world);
  const std::size_t free = lighting::kMaxShadowedLights - scene.shadowed_lights.size();
  for (const std::size_t i : chooseColumnLights(lights, effectsOf(world, lights), free, before)) {
    const ColumnLight& light = lights[i];
    scene.column_entities.push_back(light.entity);
    std::vector<float>& apart = scene.lamps_apart[light.group];
    apart.resize(world.residency().groups()[light.group].light_columns, 0.0f);
    apart[light.column] = 1.0f;
    for (const lighting::ShadowedLight& shape : light.shapes) {
      ColumnCube cube{.shadowed_light = static_cast<std::uint32_t>(scene.shadowed_lights.size()),
                      .group = light.group,
                      .source = {}};
      if (!light.material)
        cube.source = static_cast<std::size_t>(std::ranges::find(light_entities, light.entity) -
                                               light_entities.begin());
      scene.column_cubes.push_back(cube);
      scene.shadowed_lights.push_back(shape);
      scene.own_lamps.push_back(light.material ? light.entity : ecs::Entity{});
    }
  }
}

}  // namespace

std::uint32_t LitScene::columnMask(std::size_t group) const {
  std::uint32_t mask = 0;
  for (const ColumnCube& cube : column_cubes)
    if (cube.group == group) mask |= 1u << cube.shadowed_light;
  return mask;
}

bool LitScene::needsSampling() const {
  const auto seesOthers = [&](const lighting::IncidentGroup& group) {
    const std::size_t own = group.body == lighting::CapturePoint::kNoBody ? 0 : 1;
    return bodies.size() > own + group.left_out.size();
  };
  return !lights.empty() || std::ranges::any_of(groups, seesOthers);
}

BodyProxies proxiesOf(const streaming::Residency& residency) {
  BodyProxies bodies;
  for (const streaming::ResidentGroup& group : residency.groups())
    if (group.proxy) {
      bodies.proxies.push_back(&*group.proxy);
      bodies.keys.push_back(group.id);
    }
  return bodies;
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

LitScene gatherLitScene(const World& world, float surroundings, const LitSceneOptions& options) {
  LitScene scene;
  const ecs::Registry& registry = world.registry();
  const auto& groups = world.residency().groups();

  const Suns suns = sunsOf(world, options.most_suns);
  std::vector<ecs::Entity> light_entities;
  for (auto [entity, light] : registry.view<const scene::LocalLightComponent>()) {
    if (light.power() == glm::vec3(0.0f) || std::ranges::find(suns.entities, entity) != suns.entities.end())
      continue;
    scene.lights.push_back(describe(registry, entity, light));
    light_entities.push_back(entity);
  }
  std::vector<float> shares(scene.lights.size(), 0.0f);
  if (options.shadowed_lights)
    shares = localShares(nearnessOf(world, scene.lights, light_entities), options.local_radii);
  std::vector<std::int32_t> local_of_light(scene.lights.size(), -1);
  for (std::size_t k = 0; k < scene.lights.size(); ++k) {
    if (shares[k] <= 0.0f) continue;
    std::optional<lighting::ShadowedLight> near = lighting::shadowedLightOf(scene.lights[k]);
    if (!near) continue;
    near->power *= shares[k];
    local_of_light[k] = static_cast<std::int32_t>(scene.shadowed_lights.size());
    scene.shadowed_lights.push_back(*near);
    scene.local_sources.push_back(k);
  }

  scene.own_lamps.resize(scene.shadowed_lights.size());
  scene.lamps_apart.resize(groups.size());
  if (options.column_lights) addColumnLights(world, light_entities, options.cubes_before, scene);

  std::uint32_t proxy_index = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const streaming::ResidentGroup& group = groups[g];
    const glm::mat4 world_from_group = world.worldFromGroup(g);
    const scene::Box& bounds = world.groupBounds(g);
    scene.lamps.push_back(world.lampsOf(g));
    lighting::IncidentGroup receiver;
    receiver.key = world.keyOf(g);
    receiver.samples = group.id;
    for (const glm::vec3& sample : group.light_probes)
      receiver.samples_ws.emplace_back(world_from_group * glm::vec4(sample, 1.0f));
    if (group.proxy && options.bodies) {
      receiver.body = static_cast<std::uint32_t>(scene.bodies.size());
      const glm::vec3 center = bounds.empty() ? glm::vec3(0.0f) : bounds.center();
      const float peak = group.light_columns > 0 ? peakEmission(*group.proxy, scene.lamps.back()) : 0.0f;
      const float brightness = surroundings > 0.0f ? peak / surroundings : kMaxBrightness * peak;
      scene.bodies.push_back({.body = {.proxy = proxy_index++,
                                       .world_from_proxy = world_from_group,
                                       .brightness = std::clamp(brightness, 1.0f, kMaxBrightness)},
                              .center_ws = glm::vec3(world_from_group * glm::vec4(center, 1.0f)),
                              .radius_m = bounds.radius() * scene::largestScale(world_from_group),
                              .radiance_drift = 0.0,
                              .key = receiver.key});
    }
    std::uint32_t local_mask = 0, pixel_mask = scene.columnMask(g);
    for (std::size_t k = 0; k < scene.lights.size(); ++k) {
      bool by_harmonics = !world.litByColumn(g, light_entities[k]);
      float apart = 0.0f;
      const std::uint32_t bit = local_of_light[k] >= 0 ? 1u << local_of_light[k] : 0u;
      // Rays through a volume look up only its samples, not shadow cubes.
      if (by_harmonics && options.shadowed_lights && group.volume < 0) {
        if (radiiFrom(bounds, world_from_group, scene.lights[k]) == 0.0f) {
          local_mask |= bit;
          pixel_mask |= bit;
          by_harmonics = bit == 0;
          scene.local_left_out += bit == 0 ? 1 : 0;
        } else if (bit != 0 && options.local_radii > 0.0f &&
                   !shadesColumn(world, scene, g, light_entities[k], k)) {
          pixel_mask |= bit;
          apart = shares[k];
        }
      }
      receiver.lit_by.push_back(by_harmonics ? 1 : 0);
      receiver.apart.push_back(apart);
    }
    scene.local_masks.push_back(local_mask);
    scene.pixel_masks.push_back(pixel_mask);
    scene.groups.push_back(std::move(receiver));
  }
  // The transfer of a volume contains what it stands within.
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::int32_t within = world.description(groups[g].bundle).groups[groups[g].index.value].within;
    if (within < 0) continue;
    const std::size_t around =
        world.residency().bundles()[groups[g].bundle].first.groups + static_cast<std::size_t>(within);
    if (const std::uint32_t body = scene.groups[around].body; body != lighting::CapturePoint::kNoBody)
      scene.groups[g].left_out.push_back(body);
  }
  return scene;
}

namespace {

constexpr std::size_t kProxyLevel = 1;  // level of the proxies
constexpr float kLeastShare = 1e-5f;    // in radii of a body; nearer triangles are ignored

// Makes proxies on demand, placed in the world.
class Blockers {
 public:
  explicit Blockers(std::span<const bundle::CaptureProxy* const> proxies) : proxies_(proxies) {}

  const lighting::TriangleTree& of(const lighting::IncidentBody& body) {
    const auto [place, made] = trees_.try_emplace(body.key);
    if (!made || body.body.proxy >= proxies_.size()) return place->second;
    const bundle::CaptureProxy& proxy = *proxies_[body.body.proxy];
    if (proxy.levels.empty()) return place->second;
    const bundle::ProxyLevel& level = proxy.levels[std::min(kProxyLevel, proxy.levels.size() - 1)];
    std::vector<lighting::RayTriangle> triangles;
    for (std::uint32_t t = 0; t < level.triangle_count; ++t) {
      const bundle::ProxyTriangle& from = proxy.triangles[level.first_triangle + t];
      lighting::RayTriangle& triangle = triangles.emplace_back();
      triangle.front_only = from.front_only;
      for (std::size_t k = 0; k < 3; ++k)
        triangle.corners[k] =
            glm::vec3(body.body.world_from_proxy * glm::vec4(proxy.positions[from.vertices[k]], 1.0f));
    }
    place->second = lighting::TriangleTree(std::move(triangles), kLeastShare * body.radius_m);
    return place->second;
  }

 private:
  std::span<const bundle::CaptureProxy* const> proxies_;
  std::map<std::uint64_t, lighting::TriangleTree> trees_;  // indexed by the body's key
};

// Returns whether a sphere around the body comes between the point and the light.
bool mayHide(const lighting::IncidentBody& body, const lighting::LocalLight& light, const glm::vec3& point) {
  const glm::vec3 way = light.position_ws - point, to_body = body.center_ws - point;
  const float squared = glm::dot(way, way);
  const float along = squared > 0.0f ? std::clamp(glm::dot(way, to_body) / squared, 0.0f, 1.0f) : 0.0f;
  return glm::distance(to_body, along * way) < body.radius_m + light.extent_m();
}

// Returns the share of the light that the bodies let through.
float shareThrough(std::span<const lighting::IncidentBody* const> bodies, Blockers& blockers,
                   const lighting::LocalLight& light, const glm::vec3& point) {
  const std::optional<lighting::LightQuery> query = lighting::queryOf(light, point);
  if (!query) return 1.0f;
  const std::vector<glm::vec3> directions = lighting::capture::discDirections(*query);
  if (directions.empty()) return 1.0f;
  std::vector<bool> hidden(directions.size(), false);
  for (const lighting::IncidentBody* body : bodies) {
    const lighting::TriangleTree& tree = blockers.of(*body);
    for (std::size_t i = 0; i < directions.size(); ++i)
      hidden[i] = hidden[i] || tree.blocked(point, query->distance_m * directions[i], 1.0f);
  }
  const auto count = std::ranges::count(hidden, false);
  return static_cast<float>(count) / static_cast<float>(directions.size());
}

}  // namespace

std::size_t ApartOcclusion::update(LitScene& scene, std::span<const bundle::CaptureProxy* const> proxies,
                                   std::uint64_t version) {
  Inputs inputs{
      .version = version, .groups = std::vector<Group>(scene.groups.size()), .lights = {}, .bodies = {}};
  bool any = false;
  for (std::size_t g = 0; g < scene.groups.size(); ++g) {
    const lighting::IncidentGroup& group = scene.groups[g];
    if (group.left_out.empty() || std::ranges::all_of(group.apart, [](float share) { return share == 0.0f; }))
      continue;
    inputs.groups[g] = {group.samples_ws, group.apart, group.left_out};
    any = true;
  }
  if (any) {
    inputs.lights = scene.lights;
    for (lighting::LocalLight& light : inputs.lights) light.power = {};
    for (const lighting::IncidentBody& body : scene.bodies)
      inputs.bodies.push_back(body.body.world_from_proxy);
  }
  std::size_t probes = 0;
  if (open_.size() != scene.groups.size() || inputs != traced_) {
    open_.assign(scene.groups.size(), {});
    Blockers blockers(proxies);
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
      const Group& group = inputs.groups[g];
      probes += group.samples_ws.size();
      for (const glm::vec3& sample : group.samples_ws)
        for (std::size_t k = 0; k < scene.lights.size(); ++k) {
          std::vector<const lighting::IncidentBody*> bodies;
          if (group.apart[k] > 0.0f)
            for (const std::uint32_t body : group.left_out)
              if (mayHide(scene.bodies[body], scene.lights[k], sample)) bodies.push_back(&scene.bodies[body]);
          open_[g].push_back(bodies.empty() ? 1.0f : shareThrough(bodies, blockers, scene.lights[k], sample));
        }
    }
    traced_ = std::move(inputs);
  }
  for (std::size_t g = 0; g < scene.groups.size(); ++g) scene.groups[g].open = open_[g];
  return probes;
}

}  // namespace lambent::frame
