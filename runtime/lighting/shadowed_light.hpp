// Describes a light that stands among the surfaces of a rigid group, where light from infinity cannot
// describe it. Its direct light is shaded per pixel with a shadow cube map, and its bounces travel by patches
// and links (runtime/bounces/patch_bounces.hpp), or by a column of the group's transfer.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

namespace lambent::lighting {

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

}  // namespace lambent::lighting
