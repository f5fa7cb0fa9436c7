#include "runtime/lighting/local_light.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "runtime/sh/local_light.hpp"

namespace lambent::lighting {

sh::LightVector lightAt(const LocalLight& light, const glm::vec3& point_ws, int order) {
  const glm::dvec3 light_from_point = glm::dvec3(light.position_ws) - glm::dvec3(point_ws);
  const glm::dvec3 axis(light.direction_ws);
  switch (light.kind) {
    case LocalLight::Kind::Point:
      return sh::pointLight(order, light_from_point, light.power, light.range_m);
    case LocalLight::Kind::Spot:
      return sh::spotLight(order, light_from_point, {axis, light.inner_cone_rad, light.outer_cone_rad},
                           light.power, light.range_m);
    case LocalLight::Kind::Directional:
      return sh::directionalLight(order, -axis, light.power);
    case LocalLight::Kind::Sphere:
      return sh::sphereLight(order, light_from_point, light.radius_m, light.power);
    case LocalLight::Kind::Disc:
      return sh::discAreaLight(order, light_from_point, axis, light.radius_m, light.power);
  }
  return sh::LightVector(order);
}

std::optional<LightQuery> queryOf(const LocalLight& light, const glm::vec3& point_ws) {
  if (light.power == glm::vec3(0.0f)) return std::nullopt;
  if (light.kind == LocalLight::Kind::Directional) return LightQuery{.direction = -light.direction_ws};
  const glm::vec3 towards = light.position_ws - point_ws;
  const float distance = glm::length(towards);
  const float extent = light.extent_m();
  if (!(distance > extent) || !std::isfinite(distance)) return std::nullopt;
  LightQuery query{.direction = towards / distance, .distance_m = distance - extent};
  query.angular_radius_rad = std::asin(std::min(1.0f, extent / distance));
  return query;
}

}  // namespace lambent::lighting
