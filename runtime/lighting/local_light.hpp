// Describes a light that stands in the scene, as the lighting system sees it: its current place and its
// strength. Its light at a point is the closed form in runtime/sh/local_light.hpp. Kinds and units are those
// of scene::LocalLightComponent.
#pragma once

#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "runtime/lighting/capture.hpp"
#include "runtime/lighting/shadowed_light.hpp"
#include "runtime/sh/light_vector.hpp"

namespace lambent::lighting {

struct LocalLight {
  enum class Kind : std::uint8_t { Point, Spot, Directional, Sphere, Disc };
  Kind kind = Kind::Point;
  glm::vec3 position_ws{0.0f};
  glm::vec3 direction_ws{0.0f, 0.0f, -1.0f};  // unit vector in which it shines; unused by Point and Sphere
  glm::vec3 power{0.0f};                      // Point, Spot: W/sr; Directional: W/m²; Sphere, Disc: radiance
  float radius_m = 0.0f;                      // Sphere, Disc
  float range_m = 0.0f;                       // Point, Spot; 0: unlimited
  float inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;  // Spot
  bool operator==(const LocalLight&) const = default;

  // Returns how far the surface of a Sphere or Disc reaches; 0 for other kinds.
  float extent_m() const { return kind == Kind::Sphere || kind == Kind::Disc ? radius_m : 0.0f; }
};

// Returns the unoccluded light at a point, in world axes.
sh::LightVector lightAt(const LocalLight& light, const glm::vec3& point_ws, int order);

// Returns the query for the light's visible share, or nothing if the light gives nothing or contains the
// point.
std::optional<LightQuery> queryOf(const LocalLight& light, const glm::vec3& point_ws);

// Returns the light for shading per pixel, or nothing for a directional light.
std::optional<ShadowedLight> shadowedLightOf(const LocalLight& light);

}  // namespace lambent::lighting
