// A light that stands in the scene as the lighting system sees it: where it is now and what it gives. Its
// light at a point is the closed form of runtime/sh/local_light.hpp. Kinds, units and words are those of
// scene::LocalLightComponent.
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
  glm::vec3 direction_ws{0.0f, 0.0f, -1.0f};  // unit, the way it shines; not of Point and Sphere
  glm::vec3 power{0.0f};                      // Point, Spot: W/sr; Directional: W/m²; Sphere, Disc: radiance
  float radius_m = 0.0f;                      // Sphere, Disc
  float range_m = 0.0f;                       // Point, Spot; 0: no end
  float inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;  // Spot
  bool operator==(const LocalLight&) const = default;

  // Sphere and Disc: how far its surface reaches.
  float extent_m() const { return kind == Kind::Sphere || kind == Kind::Disc ? radius_m : 0.0f; }
};

// What arrives at a point when nothing stands between, world axes.
sh::LightVector lightAt(const LocalLight& light, const glm::vec3& point_ws, int order);

// What to ask whether anything hides it; none where it gives nothing or the point lies in it.
std::optional<LightQuery> queryOf(const LocalLight& light, const glm::vec3& point_ws);

// For shading per pixel; none for light from infinity.
std::optional<ShadowedLight> shadowedLightOf(const LocalLight& light);

}  // namespace lambent::lighting
