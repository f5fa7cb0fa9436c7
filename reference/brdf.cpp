#include "reference/brdf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/brdf/brdf.hpp"
#include "baker/jobs/parallel.hpp"
#include "reference/sampler.hpp"

namespace lambent::baker::reference {

namespace {

float power5(float x) {
  return x * x * x * x * x;
}

// Returns |x| in the space where the surface has roughness 1: n·x sqrt(1 + alpha² tan²).
float stretched(const glm::vec2& alpha, const glm::vec3& x) {
  return glm::length(glm::vec3(alpha * glm::vec2(x), x.z));
}

// This is the distribution of Trowbridge and Reitz 1975; Heitz 2014, equation 85.
float distribution(const glm::vec2& alpha, const glm::vec3& h) {
  const glm::vec2 slope = glm::vec2(h) / alpha;
  const float k = glm::dot(slope, slope) + h.z * h.z;
  return 1.0f / (kPi * alpha.x * alpha.y * k * k);
}

// Returns the BRDF times the cosine of s, without the Fresnel factors: F0 multiplies x, F90 multiplies y.
// Returns 0 if s.z <= 0.
glm::vec2 ggxValue(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s) {
  if (s.z <= 0.0f) return glm::vec2(0.0f);
  const glm::vec3 h = glm::normalize(v + s);
  // This is G2 / (4 n·v n·s), height-correlated: Heitz 2014, equations 99 and 72.
  const float visible = 0.5f / (s.z * stretched(alpha, v) + v.z * stretched(alpha, s));
  const float fresnel = power5(std::clamp(1.0f - glm::dot(v, h), 0.0f, 1.0f));
  return distribution(alpha, h) * visible * s.z * glm::vec2(1.0f - fresnel, fresnel);
}

// Returns the density of sampleGgx() per steradian of s, also of directions below the surface.
// pdf = D_v(h) / (4 v·h), with D_v = G1(v) v·h D(h) / n·v and G1 = 2 n·v / (n·v + stretched)
float ggxPdf(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s) {
  const glm::vec3 sum = v + s;
  const float length = glm::length(sum);
  if (!(length > 0.0f) || sum.z <= 0.0f) return 0.0f;
  return distribution(alpha, sum / length) / (2.0f * (v.z + stretched(alpha, v)));
}

// Samples the distribution of visible normals (Heitz 2018) by Dupuy and Benyoub, "Sampling Visible GGX
// Normals with Spherical Caps", 2023. Some directions are below the surface.
glm::vec3 sampleGgx(const glm::vec2& alpha, const glm::vec3& v, const glm::vec2& u) {
  const glm::vec3 round = glm::normalize(glm::vec3(alpha * glm::vec2(v), v.z));
  const float z = (1.0f - u.y) * (1.0f + round.z) - round.z;
  const float r = std::sqrt(std::clamp(1.0f - z * z, 0.0f, 1.0f)), angle = 2.0f * kPi * u.x;
  const glm::vec3 cap = glm::vec3(r * std::cos(angle), r * std::sin(angle), z) + round;
  const glm::vec3 h = glm::normalize(glm::vec3(alpha * glm::vec2(cap), std::max(cap.z, 1e-12f)));
  return glm::normalize(2.0f * glm::dot(v, h) * h - v);
}

}  // namespace

glm::vec2 ggxAlpha(float roughness, float strength) {
  const float alpha = std::max(roughness * roughness, kLeastAlpha);
  return {glm::mix(alpha, 1.0f, strength * strength), alpha};
}

glm::vec3 liftedView(const glm::vec3& v) {
  if (v.z >= kLeastCosine) return v;
  const float side = std::sqrt(v.x * v.x + v.y * v.y);
  const glm::vec2 along = side > 0.0f ? glm::vec2(v) / side : glm::vec2(1.0f, 0.0f);
  return {along * std::sqrt(1.0f - kLeastCosine * kLeastCosine), kLeastCosine};
}

glm::vec3 Reflector::specular(const glm::vec3& s) const {
  if (s.z <= 0.0f) return glm::vec3(0.0f);
  if (measured) {
    std::array<double, 3> f;
    measured->value({}, glm::dvec3(view), glm::dvec3(s), f);
    return glm::vec3(f[0], f[1], f[2]) * s.z;
  }
  const glm::vec2 parts = ggxValue(alpha, view, s);
  return f0 * parts.x + f90 * parts.y;
}

glm::vec3 Reflector::value(const glm::vec3& s) const {
  return specular(s) + diffuse * (std::max(s.z, 0.0f) / kPi);
}

float Reflector::pdf(const glm::vec3& s) const {
  return specular_share * ggxPdf(alpha, view, s) + (1.0f - specular_share) * std::max(s.z, 0.0f) / kPi;
}

glm::vec3 Reflector::sample(float choice, const glm::vec2& u) const {
  return choice < specular_share ? sampleGgx(alpha, view, u) : cosineDirection(u);
}

namespace {

constexpr std::uint32_t kIsotropicPoints = 512, kAnisotropicPoints = 256;

glm::vec2 albedo(const glm::vec2& alpha, const glm::vec3& view, std::uint32_t points) {
  // All entries use the same points, so that the remaining error is smooth.
  const Sampler sampler(/*seed=*/2, 0, 0);
  glm::dvec2 sum(0.0);
  for (std::uint32_t i = 0; i < points; ++i) {
    const glm::vec3 s = sampleGgx(alpha, view, sampler.pair(0, i));
    const float pdf = ggxPdf(alpha, view, s);
    if (s.z > 0.0f && pdf > 0.0f) sum += glm::dvec2(ggxValue(alpha, view, s) / pdf);
  }
  return glm::vec2(sum / static_cast<double>(points));
}

struct NodePlace {
  std::size_t below = 0;
  float share = 0.0f;
};
NodePlace between(float at, std::size_t nodes) {
  if (nodes < 2) return {};
  const float scaled = std::clamp(at, 0.0f, 1.0f) * static_cast<float>(nodes - 1);
  const auto below = std::min(static_cast<std::size_t>(scaled), nodes - 2);
  return {below, scaled - static_cast<float>(below)};
}

float node(std::size_t i, std::size_t nodes) {
  return nodes < 2 ? 0.0f : static_cast<float>(i) / static_cast<float>(nodes - 1);
}

}  // namespace

AlbedoTable AlbedoTable::build(bool anisotropic) {
  AlbedoTable out;
  out.angles_ = anisotropic ? 33 : 97;
  out.azimuths_ = anisotropic ? 7 : 1;
  out.roughnesses_ = anisotropic ? 13 : 33;
  out.strengths_ = anisotropic ? 7 : 1;
  const std::size_t rows = out.strengths_ * out.roughnesses_ * out.azimuths_;
  out.values_.resize(rows * out.angles_);
  parallelRanges(rows, 1, {}, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      const float phi = kPi / 2 * node(row % out.azimuths_, out.azimuths_);
      const glm::vec2 alpha = ggxAlpha(node(row / out.azimuths_ % out.roughnesses_, out.roughnesses_),
                                       node(row / (out.azimuths_ * out.roughnesses_), out.strengths_));
      for (std::size_t a = 0; a < out.angles_; ++a) {
        const float root = node(a, out.angles_), cosine = std::max(root * root, kLeastCosine);
        const float side = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
        out.values_[row * out.angles_ + a] =
            albedo(alpha, {side * std::cos(phi), side * std::sin(phi), cosine},
                   anisotropic ? kAnisotropicPoints : kIsotropicPoints);
      }
    }
  });
  return out;
}

glm::vec2 AlbedoTable::at(const glm::vec3& view, float roughness, float strength) const {
  const NodePlace places[4] = {between(std::sqrt(std::max(view.z, 0.0f)), angles_),
                               between(std::atan2(std::abs(view.y), std::abs(view.x)) / (kPi / 2), azimuths_),
                               between(roughness, roughnesses_), between(strength, strengths_)};
  const std::size_t strides[4] = {1, angles_, angles_ * azimuths_, angles_ * azimuths_ * roughnesses_};
  glm::vec2 sum(0.0f);
  for (unsigned corner = 0; corner < 16; ++corner) {
    std::size_t at = 0;
    float weight = 1.0f;
    for (unsigned axis = 0; axis < 4; ++axis) {
      const bool above = (corner >> axis & 1u) != 0;
      weight *= above ? places[axis].share : 1.0f - places[axis].share;
      at += strides[axis] * (places[axis].below + (above ? 1 : 0));
    }
    if (weight > 0.0f) sum += weight * values_[at];
  }
  return sum;
}

}  // namespace lambent::baker::reference
