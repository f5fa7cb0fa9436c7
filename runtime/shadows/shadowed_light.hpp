// The record of a local light that shaders read (local_shared.h), and the light that it gives: the CPU twin
// of shadowed_light.glsl, with the same names and order of terms, so that a test can compare the two. World
// axes, metres; shares are E/pi for unit power (candela, or radiance of a surface). No GL.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/lighting/local_light.hpp"
#include "runtime/shadows/local_shared.h"

namespace lambent::frame {

// Makes the record of a local light that shaders and their CPU twins read (local_shared.h), and tells what
// each kind of light has.
inline bool hasExtent(const lighting::ShadowedLight& light) {
  return light.kind == lighting::ShadowedLight::Kind::Sphere ||
         light.kind == lighting::ShadowedLight::Kind::Disc;
}

inline bool hasDirection(const lighting::ShadowedLight& light) {
  return light.kind == lighting::ShadowedLight::Kind::Spot ||
         light.kind == lighting::ShadowedLight::Kind::Disc;
}

// Returns whether the light gives any light. One with a value that is not finite gives none.
inline bool shines(const lighting::ShadowedLight& light) {
  const auto finite = [](glm::vec3 v) { return std::isfinite(v.x + v.y + v.z); };
  return finite(light.power) && finite(light.position_ws) && finite(light.direction_ws) &&
         light.power != glm::vec3(0.0f) &&
         (!hasExtent(light) || (light.radius_m > 0.0f && std::isfinite(light.radius_m)));
}

// Returns the distance at which its light ends. Lights with an extent have no limit.
inline float rangeOf(const lighting::ShadowedLight& light) {
  return !hasExtent(light) && light.range_m > 0.0f ? light.range_m : std::numeric_limits<float>::infinity();
}

inline ShadowedLightRecord recordOf(const lighting::ShadowedLight& light, float reach) {
  const float inner = std::cos(light.inner_cone_rad), outer = std::cos(light.outer_cone_rad);
  return {.position = light.position_ws,
          .reach = reach,
          .direction = light.direction_ws,
          .kind = static_cast<uint>(light.kind),
          .power = light.power,
          .radius = light.radius_m,
          .cos_outer = outer,
          .cone_scale = 1.0f / std::max(0.001f, inner - outer),
          .range = std::isinf(rangeOf(light)) ? 0.0f : light.range_m,
          .pad = 0.0f};
}

}  // namespace lambent::frame

namespace lambent::frame::ref {

// This is the CPU twin of shadowed_light.glsl, with the same names and order of terms, so that a test can
// compare the two. World axes, metres; shares are E/pi for unit power (candela, or radiance of a surface). No
// GL.
inline constexpr float kLocalPi = 3.14159265f;
inline constexpr float kLeastDistance = 0.01f;
inline constexpr float kLocalNoLength = 1e-36f;
inline constexpr float kFarSphere = 64.0f;
inline constexpr float kFarDisc = 20.0f;
inline constexpr int kDiscCorners = 24;
inline constexpr float kDiscCorner = 1.005744f;
inline constexpr float kCornerCos = 0.96592583f, kCornerSin = 0.25881905f;

inline glm::vec3 localUnit(glm::vec3 v) {
  return v / std::sqrt(std::max(glm::dot(v, v), kLocalNoLength));
}

inline void localBasis(glm::vec3 n, glm::vec3& s, glm::vec3& t) {
  const float facing = n.z >= 0.0f ? 1.0f : -1.0f;
  const float a = -1.0f / (facing + n.z), b = n.x * n.y * a;
  s = {1.0f + facing * n.x * n.x * a, facing * b, -facing * n.x};
  t = {b, facing + n.y * n.y * a, -n.y};
}

inline float punctualShare(const ShadowedLightRecord& light, glm::vec3 to_light) {
  const float squared = glm::dot(to_light, to_light);
  const float least = std::max(squared, kLeastDistance * kLeastDistance);
  float share = 1.0f / least;
  if (light.range > 0.0f) {
    const float ratio = squared / (light.range * light.range);
    share *= std::clamp(1.0f - ratio * ratio, 0.0f, 1.0f);
  }
  if (light.kind == kLocalSpot) {
    const float along = -glm::dot(light.direction, localUnit(to_light));
    const float inside = std::clamp((along - light.cos_outer) * light.cone_scale, 0.0f, 1.0f);
    share *= inside * inside;
  }
  return share;
}

inline float sphereShare(float cosine, float h) {
  if (h <= 1.0f) return 1.0f;
  const float h2 = h * h, above = cosine * h;
  if (above >= 1.0f) return cosine / h2;
  if (above <= -1.0f) return 0.0f;
  if (h > kFarSphere) {
    const float rest = std::sqrt(std::max(1.0f - above * above, 0.0f));
    return std::max(above * std::acos(-above) + above * above * rest + 2.0f / 3.0f * rest * rest * rest,
                    0.0f) /
           (kLocalPi * h2 * h);
  }
  const float k = std::sqrt(std::max(1.0f - above * above, 0.0f)), w = std::sqrt(h2 - 1.0f);
  const float sine = std::sqrt(std::max(1.0f - cosine * cosine, kLocalNoLength));
  const float turned = std::acos(std::clamp(-cosine * w / sine, -1.0f, 1.0f));
  return std::max((cosine * turned - k * w) / h2 + std::atan2(k, w), 0.0f) / kLocalPi;
}

inline glm::vec3 edgeTerm(glm::vec3 a, glm::vec3 b) {
  const glm::vec3 u = localUnit(a), v = localUnit(b), turn = glm::cross(u, v);
  const float sine = glm::length(turn), angle = std::atan2(sine, glm::dot(u, v));
  return sine > 1e-7f ? turn * (angle / sine) : turn;
}

inline float discShare(glm::vec3 normal, glm::vec3 to_light, glm::vec3 direction, float radius) {
  const float facing = -glm::dot(direction, to_light);
  if (facing <= 0.0f) return 0.0f;
  const float squared = glm::dot(to_light, to_light);
  if (squared > kFarDisc * kFarDisc * radius * radius)
    return std::max(glm::dot(normal, to_light), 0.0f) * facing / squared * (radius * radius / squared);
  glm::vec3 s, t;
  localBasis(direction, s, t);
  s *= kDiscCorner * radius;
  t *= kDiscCorner * radius;
  glm::vec2 at(1.0f, 0.0f);
  glm::vec3 corner = to_light + s, sum(0.0f), leaving(0.0f), entering(0.0f);
  float height = glm::dot(normal, corner);
  bool cut = false;
  for (int i = 0; i < kDiscCorners; ++i) {
    at = {at.x * kCornerCos - at.y * kCornerSin, at.x * kCornerSin + at.y * kCornerCos};
    const glm::vec3 next = to_light + at.x * s + at.y * t;
    const float next_height = glm::dot(normal, next);
    if (height > 0.0f && next_height > 0.0f) {
      sum += edgeTerm(corner, next);
    } else if (height > 0.0f || next_height > 0.0f) {
      cut = true;
      const glm::vec3 on_horizon = corner + height / (height - next_height) * (next - corner);
      if (height > 0.0f) {
        leaving = on_horizon;
        sum += edgeTerm(corner, on_horizon);
      } else {
        entering = on_horizon;
        sum += edgeTerm(on_horizon, next);
      }
    }
    corner = next;
    height = next_height;
  }
  if (cut) sum += edgeTerm(leaving, entering);
  return std::clamp(-glm::dot(normal, sum) / (2.0f * kLocalPi), 0.0f, 1.0f);
}

inline float localShare(const ShadowedLightRecord& light, glm::vec3 normal, glm::vec3 to_light) {
  if (light.kind == kLocalDisc) return discShare(normal, to_light, light.direction, light.radius);
  const float cosine = glm::dot(normal, localUnit(to_light));
  if (light.kind == kLocalSphere) return sphereShare(cosine, glm::length(to_light) / light.radius);
  return std::max(cosine, 0.0f) * punctualShare(light, to_light) / kLocalPi;
}

}  // namespace lambent::frame::ref
