// Maps the unit square to directions and points, each with its density.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

inline constexpr float kPi = std::numbers::pi_v<float>;

// Returns a right-handed frame whose third column is n. Duff et al., "Building an Orthonormal Basis,
// Revisited", JCGT 6(1), 2017.
inline glm::mat3 frameAbout(const glm::vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  return {glm::vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x),
          glm::vec3(b, sign + n.y * n.y * a, -n.y), n};
}

// Returns a direction about +Z with pdf = z/pi, by Shirley and Chiu's concentric map, lifted by Malley's
// method.
inline glm::vec3 cosineDirection(const glm::vec2& u) {
  const glm::vec2 p = 2.0f * u - 1.0f;
  if (p.x == 0.0f && p.y == 0.0f) return {0.0f, 0.0f, 1.0f};
  const bool wide = std::abs(p.x) > std::abs(p.y);
  const float r = wide ? p.x : p.y;
  const float angle = wide ? kPi / 4.0f * (p.y / p.x) : kPi / 2.0f - kPi / 4.0f * (p.x / p.y);
  const glm::vec2 disc = r * glm::vec2(std::cos(angle), std::sin(angle));
  return {disc, std::sqrt(std::max(0.0f, 1.0f - glm::dot(disc, disc)))};
}

// Returns a direction with pdf = 1/(4 pi).
inline glm::vec3 sphereDirection(const glm::vec2& u) {
  const float z = 1.0f - 2.0f * u.x, r = std::sqrt(std::max(0.0f, 1.0f - z * z)), angle = 2.0f * kPi * u.y;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// Returns a direction within the cone about +Z whose 1 - cos(half angle) is `cap`; pdf = 1/(2 pi cap).
inline glm::vec3 coneDirection(const glm::vec2& u, float cap) {
  const float below = u.x * cap;  // 1 - z, without cancellation in narrow cones
  const float r = std::sqrt(std::max(0.0f, below * (2.0f - below))), angle = 2.0f * kPi * u.y;
  return {r * std::cos(angle), r * std::sin(angle), 1.0f - below};
}

// Returns barycentric coordinates of the second and third corner, uniform over the area.
inline glm::vec2 trianglePoint(const glm::vec2& u) {
  const float root = std::sqrt(u.x);
  return {1.0f - root, root * u.y};
}

// Veach's power heuristic: the weight of a sample of density p if another strategy has density q.
inline float powerHeuristic(float p, float q) {
  if (!(p > 0.0f)) return 0.0f;
  const float ratio = q / p;
  return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace lambent::baker::reference
