#include "runtime/shadows/shadowed_light_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include "runtime/scene/transforms.hpp"
#include "runtime/shadows/key_region.hpp"
#include "runtime/shadows/shadowed_light.hpp"

namespace lambent::frame {

namespace {

// The share falls to 0 over this last part of the distance.
constexpr float kFadePart = 1.0f / 6.0f;

}  // namespace

bool standsWithin(const scene::Box& bounds, const glm::mat4& world_from_group,
                  const lighting::LocalLight& light) {
  if (bounds.empty() || light.kind == lighting::LocalLight::Kind::Directional) return false;
  const float scale = scene::largestScale(world_from_group);
  const float determinant = glm::determinant(glm::mat3(world_from_group));
  if (determinant == 0.0f || !std::isfinite(1.0f / determinant)) return false;
  const glm::vec3 place(glm::inverse(world_from_group) * glm::vec4(light.position_ws, 1.0f));
  const float reach = light.extent_m() / scale;
  return glm::all(glm::greaterThan(place, bounds.min - reach)) &&
         glm::all(glm::lessThan(place, bounds.max + reach));
}

float radiiFrom(const scene::Box& bounds, const glm::mat4& world_from_group,
                const lighting::LocalLight& light) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  if (bounds.empty() || light.kind == lighting::LocalLight::Kind::Directional) return kFar;
  const float radius = bounds.radius() * scene::largestScale(world_from_group);
  const glm::vec3 middle(world_from_group * glm::vec4(bounds.center(), 1.0f));
  const float distance = glm::distance(middle, light.position_ws);
  // Most lights are farther away than any corner of the bounds, enlarged by the light's own extent.
  const bool beyond = distance > 1.001f * (radius + std::numbers::sqrt3_v<float> * light.extent_m());
  if (!beyond && standsWithin(bounds, world_from_group, light)) return 0.0f;
  const float radii = std::max(distance - light.extent_m(), 0.0f) / radius;
  return std::isfinite(radii) ? std::max(radii, std::numeric_limits<float>::min()) : kFar;
}

std::vector<float> localShares(std::span<const float> radii_from, float radii) {
  std::vector<float> near;
  for (const float from : radii_from)
    if (from == 0.0f || from < radii) near.push_back(from);
  std::ranges::sort(near);
  const float limit = near.size() > lighting::kMaxShadowedLights ? near[lighting::kMaxShadowedLights] : radii;
  std::vector<float> shares(radii_from.size(), 0.0f);
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < shares.size() && count < lighting::kMaxShadowedLights; ++k) {
    if (radii_from[k] == 0.0f)
      shares[k] = 1.0f;
    else if (radii_from[k] < limit)
      shares[k] = std::min((limit - radii_from[k]) / (kFadePart * limit), 1.0f);
    if (shares[k] > 0.0f) ++count;
  }
  return shares;
}

namespace {

// A light that has cubes counts this many times as much as one that has none.
constexpr float kKeeps = 1.5f;
constexpr float kBesideCone = 0.1f;  // share of a spot's light where its cone does not reach
constexpr float kNearest = 0.25f;    // of the size of what is seen; limits 1/d² beside a lamp

// Returns whether the group has the size that it was baked with.
bool hasItsSize(const glm::mat4& world_from_group) {
  constexpr float kTolerance = 1e-3f;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      if (std::abs(glm::dot(glm::vec3(world_from_group[i]), glm::vec3(world_from_group[j])) -
                   (i == j ? 1.0f : 0.0f)) > kTolerance)
        return false;
  return true;
}

std::vector<lighting::ShadowedLight> spheresOf(const bundle::GroupLight& light, glm::vec3 radiance,
                                               const glm::mat4& world_from_group) {
  std::vector<lighting::ShadowedLight> spheres;
  for (const bundle::LampSphere& sphere : light.spheres)
    spheres.push_back({.kind = lighting::ShadowedLight::Kind::Sphere,
                       .position_ws = glm::vec3(world_from_group * glm::vec4(sphere.center, 1.0f)),
                       .radius_m = sphere.radius_m,
                       .body_radius_m = sphere.body_radius_m,
                       .power = radiance});
  return spheres;
}

// Returns the shape of a light at a node, or nothing if it is neither a point nor a spot, or differs from
// what was baked.
std::vector<lighting::ShadowedLight> punctualOf(const World& world, ecs::Entity entity,
                                                const gltf::Light& baked, glm::vec3 intensity) {
  using Kind = lighting::ShadowedLight::Kind;
  const auto* light = world.registry().tryGet<scene::LocalLightComponent>(entity);
  const auto* place = world.registry().tryGet<scene::WorldTransform>(entity);
  if (!light || !place) return {};
  const bool spot = baked.type == gltf::Light::Type::Spot;
  if (light->range_m != baked.range_m || light->kind != (spot ? scene::LocalLightComponent::Kind::Spot
                                                              : scene::LocalLightComponent::Kind::Point))
    return {};
  if (spot &&
      (light->inner_cone_rad != baked.inner_cone_rad || light->outer_cone_rad != baked.outer_cone_rad))
    return {};
  const glm::vec3 ahead = -glm::vec3(place->world_from_node[2]);
  const float length = glm::length(ahead);
  return {{.kind = spot ? Kind::Spot : Kind::Point,
           .position_ws = glm::vec3(place->world_from_node[3]),
           .direction_ws = length > 0.0f ? ahead / length : glm::vec3(0.0f, 0.0f, -1.0f),
           .power = intensity,
           .range_m = light->range_m,
           .inner_cone_rad = light->inner_cone_rad,
           .outer_cone_rad = light->outer_cone_rad}};
}

// Returns points in the part of the group's bounds that the camera sees: the middle, and points half-way from
// there to the corners.
std::vector<glm::vec3> pointsSeen(const World& world, std::size_t group, const spec::View& view) {
  const glm::mat4 world_from_group = world.worldFromGroup(group);
  const std::vector<glm::dvec3> corners =
      seenCorners(world.groupBounds(group), view.clip_from_view * view.view_from_world * world_from_group);
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& corner : corners) middle += corner / static_cast<double>(corners.size());
  std::vector<glm::vec3> points;
  for (const glm::dvec3& corner : corners)
    points.emplace_back(world_from_group * glm::vec4(0.5 * (corner + middle), 1.0f));
  if (!corners.empty()) points.emplace_back(world_from_group * glm::vec4(middle, 1.0f));
  return points;
}

float meanIrradiance(const lighting::ShadowedLight& light, std::span<const glm::vec3> points) {
  float sum = 0.0f, widest = 0.0f;
  for (const glm::vec3& point : points) widest = std::max(widest, glm::distance(point, points.back()));
  for (const glm::vec3& point : points) {
    const glm::vec3 way = point - light.position_ws;
    const float squared = glm::dot(way, way), least = kNearest * widest;
    // Few points may all miss a narrow cone that shines on something between them.
    float cone = 1.0f;
    if (light.kind == lighting::ShadowedLight::Kind::Spot &&
        glm::dot(way, light.direction_ws) < std::cos(light.outer_cone_rad) * std::sqrt(squared))
      cone = kBesideCone;
    sum += cone * intensityOf(light) / (squared + least * least);
  }
  return points.empty() ? 0.0f : sum / static_cast<float>(points.size());
}

}  // namespace

std::vector<ColumnLight> findColumnLights(const World& world) {
  std::vector<ColumnLight> found;
  const auto& groups = world.residency().groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const bundle::Description& description = world.description(groups[g].bundle);
    const bundle::Group& described = description.groups[groups[g].index.value];
    const glm::mat4 world_from_group = world.worldFromGroup(g);
    if (groups[g].volume >= 0 || described.lights.empty() || !hasItsSize(world_from_group)) continue;
    const std::vector<glm::vec3> strengths = world.lampsOf(g);
    const std::vector<ecs::Entity>& entities = world.instance(groups[g].bundle).lamps[groups[g].index.value];
    for (std::uint32_t k = 0; k < described.lights.size(); ++k) {
      const bundle::GroupLight& light = described.lights[k];
      ColumnLight one{.group = g, .column = k, .entity = entities[k], .shapes = {}};
      one.material = light.kind == bundle::GroupLight::Kind::Material;
      if (one.material) {
        one.shapes = spheresOf(light, strengths[k], world_from_group);
      } else {
        const std::int32_t carried = description.nodes[light.index].light;
        one.shapes = punctualOf(world, entities[k], description.lights[static_cast<std::size_t>(carried)],
                                strengths[k]);
      }
      if (!one.shapes.empty() && std::ranges::all_of(one.shapes, shines)) found.push_back(std::move(one));
    }
  }
  return found;
}

float intensityOf(const lighting::ShadowedLight& light) {
  const float luminance = glm::dot(light.power, glm::vec3(0.2126f, 0.7152f, 0.0722f));
  return hasExtent(light) ? luminance * std::numbers::pi_v<float> * light.radius_m * light.radius_m
                          : luminance;
}

std::vector<float> effectsOf(const World& world, std::span<const ColumnLight> lights) {
  std::map<std::size_t, std::vector<glm::vec3>> seen_of_group;
  std::vector<float> effects;
  for (const ColumnLight& light : lights) {
    const auto [seen, made] = seen_of_group.try_emplace(light.group);
    if (made && world.view()) seen->second = pointsSeen(world, light.group, *world.view());
    effects.push_back(0.0f);
    for (const lighting::ShadowedLight& shape : light.shapes)
      effects.back() += world.view() ? meanIrradiance(shape, seen->second) : intensityOf(shape);
  }
  return effects;
}

std::vector<std::size_t> chooseColumnLights(std::span<const ColumnLight> lights,
                                            std::span<const float> effects, std::size_t cubes,
                                            std::span<const ecs::Entity> before) {
  std::vector<float> worth(effects.begin(), effects.end());
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (std::ranges::find(before, lights[i].entity) != before.end()) worth[i] *= kKeeps;
  std::vector<std::size_t> order(lights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return worth[i]; });
  std::vector<std::size_t> chosen;
  for (const std::size_t i : order) {
    if (lights[i].shapes.size() > cubes) continue;
    cubes -= lights[i].shapes.size();
    chosen.push_back(i);
  }
  std::ranges::sort(chosen);  // so that cubes are not drawn again where the order of effects changes alone
  return chosen;
}

}  // namespace lambent::frame
