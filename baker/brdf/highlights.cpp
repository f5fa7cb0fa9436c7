#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "baker/brdf/surface_brdfs.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// Returns |x| in the space where the surface has roughness 1.
float stretched(const PointReflection& at, const glm::vec3& x) {
  return glm::length(glm::vec3(at.alpha_t * x.x, at.alpha_b * x.y, x.z));
}

glm::vec3 visibleNormal(const PointReflection& at, const glm::vec3& v, const glm::vec2& u) {
  const glm::vec3 round = glm::normalize(glm::vec3(at.alpha_t * v.x, at.alpha_b * v.y, v.z));
  const float z = (1.0f - u.y) * (1.0f + round.z) - round.z;
  const float r = std::sqrt(std::clamp(1.0f - z * z, 0.0f, 1.0f)),
              angle = 2.0f * std::numbers::pi_v<float> * u.x;
  const glm::vec3 cap = glm::vec3(r * std::cos(angle), r * std::sin(angle), z) + round;
  return glm::normalize(glm::vec3(at.alpha_t * cap.x, at.alpha_b * cap.y, std::max(cap.z, 1e-12f)));
}

}  // namespace

HighlightSample sampleHighlight(const PointReflection& at, const glm::vec3& to, const glm::vec2& u) {
  const glm::vec3 bitangent = glm::cross(at.normal, at.tangent);
  glm::vec3 v(glm::dot(to, at.tangent), glm::dot(to, bitangent), glm::dot(to, at.normal));
  if (v.z < bundle::kLeastViewCosine) {
    const float side = std::sqrt(v.x * v.x + v.y * v.y);
    const float keep = std::sqrt(1.0f - bundle::kLeastViewCosine * bundle::kLeastViewCosine);
    v = side > 0.0f ? glm::vec3(v.x / side * keep, v.y / side * keep, bundle::kLeastViewCosine)
                    : glm::vec3(keep, 0.0f, bundle::kLeastViewCosine);
  }
  const glm::vec3 h = visibleNormal(at, v, u);
  const float along = glm::dot(v, h);
  const glm::vec3 s = 2.0f * along * h - v;
  if (!(s.z > 0.0f)) return {};
  const float past = std::clamp(1.0f - along, 0.0f, 1.0f), squared = past * past;
  const float fresnel = squared * squared * past;
  // This is G2/G1 of the height-correlated Smith term.
  const float of_v = stretched(at, v);
  const float shadowing = s.z * (v.z + of_v) / (s.z * of_v + v.z * stretched(at, s));
  const glm::vec3 direction = glm::normalize(s.x * at.tangent + s.y * bitangent + s.z * at.normal);
  const float below = std::min(glm::dot(direction, at.geometric), 0.0f);
  return {.direction = direction,
          .ray = glm::normalize(direction - 2.0f * below * at.geometric),
          .weight = shadowing * glm::mix(at.f0, glm::vec3(at.f90), fresnel)};
}

glm::vec2 choices(std::uint32_t number, std::uint32_t step) {
  // The result is frac(n / g) and frac(n / g²) with g³ = g + 1, in units of 2^-32; the shift is a hash of the
  // step.
  std::uint32_t shift = (step + 1u) * 0x9E3779B9u;
  shift = (shift ^ shift >> 16) * 0x7FEB352Du;
  const std::uint32_t x = number * 3242174889u + shift, y = number * 2447445414u + (shift ^ shift << 13);
  return {static_cast<float>(x >> 8) * 0x1p-24f, static_cast<float>(y >> 8) * 0x1p-24f};
}

namespace {

constexpr std::size_t kPlaces = 512;
constexpr std::array kCosines = {0.9f, 0.65f, 0.4f, 0.18f};
constexpr float kGoldenAngle = 2.39996323f;

// Returns a direction with this cosine to the triangle's normal, rotated about it by `turn`.
glm::vec3 viewOf(const GroupGeometry& geometry, std::uint32_t triangle, float cosine, float turn) {
  const glm::uvec3& corners = geometry.triangles[triangle];
  const glm::vec3 a = geometry.positions[corners.x], ab = geometry.positions[corners.y] - a;
  const glm::vec3 normal = glm::normalize(glm::cross(ab, geometry.positions[corners.z] - a));
  const glm::vec3 along = glm::normalize(ab), across = glm::cross(normal, along);
  const float sine = std::sqrt(1.0f - cosine * cosine);
  return cosine * normal + sine * (std::cos(turn) * along + std::sin(turn) * across);
}

}  // namespace

std::array<double, 6> kernelPower(const GroupGeometry& geometry, const SurfaceBrdfs& brdfs, int order) {
  std::vector<std::uint32_t> glossy;
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t)
    if (brdfs.glossy(t)) glossy.push_back(t);
  const auto count = static_cast<std::size_t>(sh::coefficientCount(order));
  std::vector<float> kernel(3 * count);
  std::array<double, 6> power{};
  const std::size_t places = std::min(kPlaces, glossy.size());
  for (std::size_t p = 0; p < places; ++p) {
    const std::uint32_t triangle = glossy[p * glossy.size() / places];
    for (const float cosine : kCosines) {
      brdfs.exitKernel(triangle, 1.0f / 3.0f, 1.0f / 3.0f,
                       viewOf(geometry, triangle, cosine, kGoldenAngle * static_cast<float>(p)), kernel);
      for (std::size_t i = 0; i < kernel.size(); ++i)
        power[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i % count)))] +=
            double{kernel[i]} * double{kernel[i]};
    }
  }
  for (int l = 5; l >= 0; --l) {
    double& own = power[static_cast<std::size_t>(l)];
    own = power[0] > 0.0 ? own / (power[0] * (2 * l + 1)) : (l == 0 ? 1.0 : 0.0);
  }
  return power;
}

}  // namespace lambent::baker
