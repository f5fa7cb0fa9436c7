#include "reference/lamps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "reference/sampler.hpp"
#include "runtime/sh/local_light.hpp"

namespace lambent::baker::reference {

namespace {

// Returns the mean over the triangle from seven points. It is never 0, because a texture may emit only
// between them.
double meanBrightness(const Surfaces& surfaces, std::uint32_t surface, std::uint32_t triangle) {
  constexpr glm::vec2 kPlaces[] = {{1.0f / 3.0f, 1.0f / 3.0f},
                                   {0.05f, 0.05f},
                                   {0.9f, 0.05f},
                                   {0.05f, 0.9f},
                                   {0.45f, 0.1f},
                                   {0.1f, 0.45f},
                                   {0.45f, 0.45f}};
  const auto mean = [](const glm::vec3& c) { return (double{c.r} + double{c.g} + double{c.b}) / 3.0; };
  double sum = 0.0;
  for (const glm::vec2& at : kPlaces)
    sum += mean(surfaces.emittedAt({.surface = surface, .triangle = triangle, .u = at.x, .v = at.y}));
  return sum / std::size(kPlaces) + 0.02 * mean(surfaces.surfaces()[surface].material.emissive);
}

}  // namespace

EmissiveTriangles::EmissiveTriangles(const Surfaces& surfaces) : surfaces_(surfaces) {
  std::vector<double> areas;
  cumulated_ = {0.0};
  for (std::uint32_t s = 0; s < surfaces.surfaces().size(); ++s) {
    const Surface& surface = surfaces.surfaces()[s];
    const gltf::Material& material = surface.material;
    if (material.unlit || material.emissive == glm::vec3(0.0f) ||
        material.alpha_mode == gltf::AlphaMode::Blend)
      continue;
    for (std::uint32_t t = surface.first_triangle; t < surface.first_triangle + surface.triangle_count; ++t) {
      const double area = 0.5 * glm::length(surfaces.areaVector(t));
      const double power = area * meanBrightness(surfaces, s, t) * (material.double_sided ? 2.0 : 1.0);
      if (!(power > 0.0)) continue;
      triangles_.push_back(t);
      surface_of_.push_back(s);
      areas.push_back(area);
      cumulated_.push_back(cumulated_.back() + power);
    }
  }
  if (triangles_.empty()) return;
  const double sum = cumulated_.back();
  for (double& value : cumulated_) value /= sum;
  per_area_.assign(surfaces.triangles().size(), 0.0f);
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    per_area_[triangles_[i]] = static_cast<float>((cumulated_[i + 1] - cumulated_[i]) / areas[i]);
}

EmissiveTriangles::Sample EmissiveTriangles::sample(float choice, const glm::vec2& u) const {
  const auto above = std::upper_bound(cumulated_.begin() + 1, cumulated_.end() - 1, double{choice});
  const auto i = static_cast<std::size_t>(above - cumulated_.begin()) - 1;
  const glm::vec2 at = trianglePoint(u);
  Sample out;
  out.hit = {.surface = surface_of_[i], .triangle = triangles_[i], .u = at.x, .v = at.y};
  const glm::uvec3 t = surfaces_.triangles()[triangles_[i]];
  const auto& p = surfaces_.positions();
  out.position = (1.0f - at.x - at.y) * p[t.x] + at.x * p[t.y] + at.y * p[t.z];
  out.normal = glm::vec3(glm::normalize(surfaces_.areaVector(triangles_[i])));
  out.double_sided = surfaces_.surfaces()[surface_of_[i]].material.double_sided;
  out.per_area = per_area_[triangles_[i]];
  return out;
}

float EmissiveTriangles::perArea(const Hit& hit) const {
  return per_area_.empty() ? 0.0f : per_area_[hit.triangle];
}

std::vector<PunctualLight> punctualLights(const Scene& scene) {
  std::vector<PunctualLight> out;
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].light < 0) continue;
    PunctualLight light{.light = scene.lights[static_cast<std::size_t>(scene.nodes[n].light)],
                        .position = glm::vec3(world[n][3])};
    const glm::vec3 along = -glm::vec3(world[n][2]);
    if (glm::length(along) > 0.0f) light.along = glm::normalize(along);
    out.push_back(std::move(light));
  }
  return out;
}

// Follows KHR_lights_punctual, "Range Property" and "Inner and Outer Cone Angles".
std::optional<Beam> beamAt(const PunctualLight& light, const glm::vec3& position) {
  const gltf::Light& l = light.light;
  Beam beam{.distance = std::numeric_limits<float>::infinity(), .irradiance = l.intensity * l.color};
  if (l.type == gltf::Light::Type::Directional) {
    beam.to_light = -light.along;
    return beam;
  }
  const glm::vec3 to = light.position - position;
  beam.distance = glm::length(to);
  if (!(beam.distance > 0.0f)) return std::nullopt;
  beam.to_light = to / beam.distance;
  float fade = 1.0f / (beam.distance * beam.distance);
  if (l.range_m > 0.0f) {
    const float share = beam.distance / l.range_m, share2 = share * share;
    fade *= std::clamp(1.0f - share2 * share2, 0.0f, 1.0f);
  }
  if (l.type == gltf::Light::Type::Spot) {
    const float cos_outer = std::cos(l.outer_cone_rad);
    const float scale = 1.0f / std::max(0.001f, std::cos(l.inner_cone_rad) - cos_outer);
    const float inside = std::clamp((glm::dot(light.along, -beam.to_light) - cos_outer) * scale, 0.0f, 1.0f);
    fade *= inside * inside;
  }
  if (!(fade > 0.0f)) return std::nullopt;
  beam.irradiance *= fade;
  return beam;
}

namespace {

// Returns 1 - cos of the half angle of a sphere, without cancellation if it is far away.
double capOf(double radius, double distance) {
  const double sine = radius / distance, sine2 = sine * sine;
  return sine2 / (1.0 + std::sqrt(std::max(0.0, 1.0 - sine2)));
}

std::optional<WayToLight> sample(const spec::SphereLight& light, const glm::vec3& point, const glm::vec2& u) {
  const glm::dvec3 to = light.position_ws - glm::dvec3(point);
  const double distance = glm::length(to), radius = double{light.radius_m};
  if (!(radius > 0.0) || distance <= radius) return std::nullopt;
  const auto cap = static_cast<float>(capOf(radius, distance));
  if (!(cap > 0.0f)) return std::nullopt;
  const glm::vec3 local = coneDirection(u, cap);
  // The distance is that of the centre along the ray, minus half the chord.
  const double aside2 =
      distance * distance * (double{local.x} * double{local.x} + double{local.y} * double{local.y});
  const double near = distance * double{local.z} - std::sqrt(std::max(0.0, radius * radius - aside2));
  return WayToLight{.dir = glm::normalize(frameAbout(glm::vec3(to / distance)) * local),
                    .distance = static_cast<float>(near),
                    .radiance = light.radiance,
                    .pdf = 1.0f / (2.0f * kPi * cap)};
}

std::optional<WayToLight> look(const spec::SphereLight& light, const glm::vec3& point, const glm::vec3& dir) {
  const glm::dvec3 to = light.position_ws - glm::dvec3(point), along(dir);
  const double radius = double{light.radius_m}, distance = glm::length(to), middle = glm::dot(to, along);
  const glm::dvec3 aside = to - middle * along;
  const double half2 = radius * radius - glm::dot(aside, aside);
  if (!(radius > 0.0) || half2 < 0.0) return std::nullopt;
  WayToLight way{.dir = dir, .radiance = light.radiance};
  if (distance <= radius) {
    way.distance = static_cast<float>(middle + std::sqrt(half2));
    return way;
  }
  if (middle <= 0.0) return std::nullopt;
  way.distance = static_cast<float>(middle - std::sqrt(half2));
  way.pdf = static_cast<float>(1.0 / (2.0 * std::numbers::pi * capOf(radius, distance)));
  return way;
}

// Converts density per area to solid angle. Returns nothing in the disc's plane and behind it.
std::optional<WayToLight> towards(const spec::DiscLight& light, const glm::dvec3& to) {
  const double distance = glm::length(to), radius = double{light.radius_m};
  if (!(distance > 0.0)) return std::nullopt;
  const glm::dvec3 dir = to / distance;
  const double facing = -glm::dot(glm::dvec3(light.normal_ws), dir);
  const auto pdf = static_cast<float>(distance * distance / (std::numbers::pi * radius * radius * facing));
  if (!(facing > 0.0) || !(pdf > 0.0f) || !std::isfinite(pdf)) return std::nullopt;
  return WayToLight{.dir = glm::vec3(dir),
                    .distance = static_cast<float>(distance),
                    .radiance = light.radiance,
                    .pdf = pdf};
}

std::optional<WayToLight> sample(const spec::DiscLight& light, const glm::vec3& point, const glm::vec2& u) {
  if (!(light.radius_m > 0.0f)) return std::nullopt;
  // Cosine-distributed directions, projected onto the plane, are uniform over a disc.
  const glm::vec3 on = cosineDirection(u);
  const glm::vec3 offset = light.radius_m * (frameAbout(light.normal_ws) * glm::vec3(on.x, on.y, 0.0f));
  return towards(light, light.position_ws + glm::dvec3(offset) - glm::dvec3(point));
}

std::optional<WayToLight> look(const spec::DiscLight& light, const glm::vec3& point, const glm::vec3& dir) {
  const glm::dvec3 to = light.position_ws - glm::dvec3(point), along(dir), normal(light.normal_ws);
  const double facing = -glm::dot(normal, along), height = -glm::dot(normal, to);
  if (!(light.radius_m > 0.0f) || !(facing > 0.0) || !(height > 0.0)) return std::nullopt;
  const glm::dvec3 there = height / facing * along;
  const double radius = double{light.radius_m};
  const glm::dvec3 aside = there - to;
  if (glm::dot(aside, aside) > radius * radius) return std::nullopt;
  return towards(light, there);
}

sh::LightVector truncated(const spec::SphereLight& light, int order, const glm::dvec3& point) {
  return sh::sphereLight(order, light.position_ws - point, double{light.radius_m}, light.radiance);
}

sh::LightVector truncated(const spec::DiscLight& light, int order, const glm::dvec3& point) {
  return sh::discAreaLight(order, light.position_ws - point, glm::dvec3(light.normal_ws),
                           double{light.radius_m}, light.radiance);
}

}  // namespace

std::optional<WayToLight> sampleShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec2& u) {
  return std::visit([&](const auto& shape) { return sample(shape, point, u); }, light);
}

std::optional<WayToLight> lookAtShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec3& dir) {
  return std::visit([&](const auto& shape) { return look(shape, point, dir); }, light);
}

sh::LightVector shapeLight(const spec::LocalLight& light, int order, const glm::vec3& point) {
  return std::visit([&](const auto& shape) { return truncated(shape, order, glm::dvec3(point)); }, light);
}

}  // namespace lambent::baker::reference
