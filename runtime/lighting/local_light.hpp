// Describes a light that stands in the scene, as the lighting system sees it: its current place and its
// strength. Its light at a point is the closed form in runtime/sh/local_light.hpp. Kinds and units are those
// of scene::LocalLightComponent.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/lighting/capture_plan.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::lighting {

struct LocalLight {
  using Kind = scene::LocalLightComponent::Kind;
  Kind kind = Kind::Point;
  glm::vec3 position_ws{0.0f};
  glm::vec3 direction_ws{0.0f, 0.0f, -1.0f};  // unit vector in which it shines; unused by Point and Sphere
  float radius_m = 0.0f;                      // Sphere, Disc
  float body_radius_m = 0.0f;  // Sphere: surfaces within this radius are its own; 0: within radius_m
  glm::vec3 power{0.0f};       // Point, Spot: candela; Directional: lux; Sphere, Disc: radiance
  float range_m = 0.0f;        // Point, Spot: distance at which it fades out; 0: never
  float inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;  // Spot
  bool operator==(const LocalLight&) const = default;

  // Returns how far the surface of a Sphere or Disc reaches; 0 for other kinds.
  float extent_m() const { return kind == Kind::Sphere || kind == Kind::Disc ? radius_m : 0.0f; }
};

// One picture has at most this many lights that are shaded per pixel with shadow cubes.
inline constexpr std::uint32_t kMaxShadowedLights = 8;

inline bool hasExtent(const LocalLight& light) {
  return light.kind == LocalLight::Kind::Sphere || light.kind == LocalLight::Kind::Disc;
}

inline bool hasDirection(const LocalLight& light) {
  return light.kind == LocalLight::Kind::Spot || light.kind == LocalLight::Kind::Disc;
}

// Returns whether the light gives any light. One with a value that is not finite gives none.
inline bool shines(const LocalLight& light) {
  const auto finite = [](glm::vec3 v) { return std::isfinite(v.x + v.y + v.z); };
  return finite(light.power) && finite(light.position_ws) && finite(light.direction_ws) &&
         light.power != glm::vec3(0.0f) &&
         (!hasExtent(light) || (light.radius_m > 0.0f && std::isfinite(light.radius_m)));
}

// Returns the distance at which its light ends. Lights with an extent have no limit.
inline float rangeOf(const LocalLight& light) {
  return !hasExtent(light) && light.range_m > 0.0f ? light.range_m : std::numeric_limits<float>::infinity();
}

// Returns the unit vector in which lights at a node shine.
inline glm::vec3 shiningAlong(const glm::mat4& world_from_node) {
  const glm::vec3 ahead = -glm::vec3(world_from_node[2]);
  const float length = glm::length(ahead);
  return length > 0.0f ? ahead / length : glm::vec3(0.0f, 0.0f, -1.0f);
}

// States how a light of the scene reaches a rigid group.
struct LightCarrier {
  enum class Path : std::uint8_t {
    Harmonics,     // at light probes
    Cube,          // a shadow cube per pixel; patches bounce it
    Column,        // a column of the group's own transfer
    ColumnAndCube  // a shadow cube per pixel; the column bounces it
  };
  Path path = Path::Harmonics;
  // Gives, for Harmonics, the share of direct light that a shadow cube brings per pixel, 0..1. This share is
  // added to the key lights, of which transfer carries only the bounces.
  float per_pixel = 0.0f;
  bool operator==(const LightCarrier&) const = default;

  bool harmonics() const { return path == Path::Harmonics; }
  float apart() const { return harmonics() ? per_pixel : 0.0f; }
};

// Returns the unoccluded light at a point, in world axes.
sh::LightVector lightAt(const LocalLight& light, const glm::vec3& point_ws, int order);

// Returns the query for the light's visible share, or nothing if the light gives nothing or contains the
// point.
std::optional<LightQuery> queryOf(const LocalLight& light, const glm::vec3& point_ws);

}  // namespace lambent::lighting
