// A light that stands among the surfaces of a rigid group, where light from infinity cannot describe it: its
// direct light is shaded per pixel with a shadow cube map, and what the surfaces send on of it comes by
// patches and links (frame/patch_bounces.hpp).
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

namespace lambent::lighting {

struct ShadowedLight {
  enum class Kind : std::uint32_t { Point, Spot, Sphere, Disc };
  Kind kind = Kind::Point;
  glm::vec3 position_ws{0.0f};
  glm::vec3 direction_ws{0.0f, 0.0f, -1.0f};  // unit; Spot and Disc shine this way
  float radius_m = 0.0f;                      // Sphere, Disc
  glm::vec3 power{0.0f};                      // Point, Spot: candela; Sphere, Disc: radiance
  float range_m = 0.0f;                       // Point, Spot: where it fades out; 0: never
  float inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;
  bool operator==(const ShadowedLight&) const = default;
};

// As many at a time as one picture has.
inline constexpr std::uint32_t kMaxShadowedLights = 4;

}  // namespace lambent::lighting
