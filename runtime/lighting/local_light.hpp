// Describes a light that stands in the scene, as the lighting system sees it: its current place and its
// strength. Its light at a point is the closed form in runtime/sh/local_light.hpp. Kinds and units are those
// of scene::LocalLightComponent.
#pragma once

#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "runtime/lighting/capture.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::lighting {

// Describes a light that stands among the surfaces of a rigid group, where light from infinity cannot
// describe it. Its direct light is shaded per pixel with a shadow cube map, and its bounces travel by patches
// and links (runtime/bounces/patch_bounces.hpp), or by a column of the group's transfer.
struct ShadowedLight {
  enum class Kind : std::uint32_t { Point, Spot, Sphere, Disc };
  Kind kind = Kind::Point;
  glm::vec3 position_ws{0.0f};
  glm::vec3 direction_ws{0.0f, 0.0f, -1.0f};  // unit vector in which Spot and Disc shine
  float radius_m = 0.0f;                      // Sphere, Disc
  float body_radius_m = 0.0f;  // Sphere: surfaces within this radius are its own; 0: within radius_m
  glm::vec3 power{0.0f};       // Point, Spot: candela; Sphere, Disc: radiance
  float range_m = 0.0f;        // Point, Spot: distance at which it fades out; 0: never
  float inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;
  bool operator==(const ShadowedLight&) const = default;
};

// One picture has at most this many.
inline constexpr std::uint32_t kMaxShadowedLights = 8;

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
