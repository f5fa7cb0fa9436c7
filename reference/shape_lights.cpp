#include "reference/shape_lights.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "reference/warp.hpp"
#include "runtime/sh/local_light.hpp"

namespace lambent::baker::reference {

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
