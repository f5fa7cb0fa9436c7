#include "reference/brdf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/import/measured_brdf.hpp"
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

}  // namespace

glm::vec2 ggxAlpha(float roughness, float strength) {
  const float alpha = std::max(roughness * roughness, kLeastAlpha);
  return {glm::mix(alpha, 1.0f, strength * strength), alpha};
}

glm::vec2 ggxValue(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s) {
  if (s.z <= 0.0f) return glm::vec2(0.0f);
  const glm::vec3 h = glm::normalize(v + s);
  // This is G2 / (4 n·v n·s), height-correlated: Heitz 2014, equations 99 and 72.
  const float visible = 0.5f / (s.z * stretched(alpha, v) + v.z * stretched(alpha, s));
  const float fresnel = power5(std::clamp(1.0f - glm::dot(v, h), 0.0f, 1.0f));
  return distribution(alpha, h) * visible * s.z * glm::vec2(1.0f - fresnel, fresnel);
}

// pdf = D_v(h) / (4 v·h), with D_v = G1(v) v·h D(h) / n·v and G1 = 2 n·v / (n·v + stretched)
float ggxPdf(const glm::vec2& alpha, const glm::vec3& v, const glm::vec3& s) {
  const glm::vec3 sum = v + s;
  const float length = glm::length(sum);
  if (!(length > 0.0f) || sum.z <= 0.0f) return 0.0f;
  return distribution(alpha, sum / length) / (2.0f * (v.z + stretched(alpha, v)));
}

// This follows Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023.
glm::vec3 sampleGgx(const glm::vec2& alpha, const glm::vec3& v, const glm::vec2& u) {
  const glm::vec3 round = glm::normalize(glm::vec3(alpha * glm::vec2(v), v.z));
  const float z = (1.0f - u.y) * (1.0f + round.z) - round.z;
  const float r = std::sqrt(std::clamp(1.0f - z * z, 0.0f, 1.0f)), angle = 2.0f * kPi * u.x;
  const glm::vec3 cap = glm::vec3(r * std::cos(angle), r * std::sin(angle), z) + round;
  const glm::vec3 h = glm::normalize(glm::vec3(alpha * glm::vec2(cap), std::max(cap.z, 1e-12f)));
  return glm::normalize(2.0f * glm::dot(v, h) * h - v);
}

glm::vec3 liftedView(const glm::vec3& v) {
  if (v.z >= kLeastCosine) return v;
  const float side = std::sqrt(v.x * v.x + v.y * v.y);
  const glm::vec2 along = side > 0.0f ? glm::vec2(v) / side : glm::vec2(1.0f, 0.0f);
  return {along * std::sqrt(1.0f - kLeastCosine * kLeastCosine), kLeastCosine};
}

glm::vec3 Reflector::specular(const glm::vec3& s) const {
  if (s.z <= 0.0f) return glm::vec3(0.0f);
  if (measured) return measured->value(view, s) * s.z;
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

namespace {

constexpr std::size_t kHalves = 257, kDifferences = 129;  // nodes of the table
constexpr std::size_t kAngles = 65;                       // nodes of the scale
constexpr std::uint32_t kIntegralPoints = 2048;           // sample points of each integral
constexpr double kSharpness = 400.0;                      // of the interpolation weights: 1/(2 sigma²)

// Returns half-vector and difference angles as coordinates 0..1 (Rusinkiewicz 1998).
glm::dvec2 placeOf(const glm::dvec3& v, const glm::dvec3& s) {
  const glm::dvec3 sum = v + s;
  // This uses atan2, because the arc cosine of a small angle has no significant digits.
  const double half = std::atan2(std::sqrt(sum.x * sum.x + sum.y * sum.y), sum.z);
  const double difference = std::atan2(glm::length(v - s), glm::length(sum));
  constexpr double kQuarter = std::numbers::pi / 2;
  return {std::sqrt(std::clamp(half / kQuarter, 0.0, 1.0)), std::clamp(difference / kQuarter, 0.0, 1.0)};
}

glm::dvec3 directionOf(float theta, float phi) {
  const double t = theta, p = phi;
  return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

struct Weighed {
  glm::dvec2 place;
  glm::dvec3 value;
};

glm::vec3 meanAt(const std::vector<Weighed>& all, const glm::dvec2& place) {
  const auto distance2 = [&](const Weighed& one) {
    const glm::dvec2 away = one.place - place;
    return glm::dot(away, away);
  };
  // Weights are relative to the nearest measurement, or they would underflow far from all of them.
  double nearest = distance2(all.front());
  for (const Weighed& one : all) nearest = std::min(nearest, distance2(one));
  double weights = 0.0;
  glm::dvec3 sum(0.0);
  for (const Weighed& one : all) {
    const double beyond = kSharpness * (distance2(one) - nearest);
    if (beyond > 40.0) continue;
    const double weight = std::exp(-beyond);
    weights += weight;
    sum += weight * one.value;
  }
  return glm::vec3(sum / weights);
}

// Returns the node below a coordinate 0..1 among `nodes`, and the fraction of the way to the next.
std::pair<std::size_t, float> nodeBelow(double at, std::size_t nodes) {
  const double scaled = std::clamp(at, 0.0, 1.0) * static_cast<double>(nodes - 1);
  const auto below = std::min(static_cast<std::size_t>(scaled), nodes - 2);
  return {below, static_cast<float>(scaled - static_cast<double>(below))};
}

float largestChannel(const glm::vec3& v) {
  return std::max({v.r, v.g, v.b});
}

}  // namespace

MeasuredReflection::MeasuredReflection(const MeasuredBrdf& measured) {
  std::vector<Weighed> all;
  for (const BrdfMeasurement& m : measured.measurements)
    all.push_back(
        {placeOf(directionOf(m.theta_i, m.phi_i), directionOf(m.theta_o, m.phi_o)), glm::dvec3(m.value)});
  values_.resize(kHalves * kDifferences);
  parallelRanges(kDifferences, 1, {}, [&](std::size_t first, std::size_t last) {
    for (std::size_t d = first; d < last; ++d)
      for (std::size_t h = 0; h < kHalves; ++h)
        values_[d * kHalves + h] = meanAt(
            all, {static_cast<double>(h) / (kHalves - 1), static_cast<double>(d) / (kDifferences - 1)});
  });
  // The width of the highlight at theta_d = 30°: GGX falls to half where tan theta_h = 0.644 alpha.
  const glm::vec3* row = &values_[kDifferences / 3 * kHalves];
  const float base = largestChannel(row[kHalves * 4 / 5]), half = 0.5f * (largestChannel(row[0]) + base);
  std::size_t h = 1;
  while (h + 1 < kHalves && largestChannel(row[h]) > half) ++h;
  const float root = static_cast<float>(h) / (kHalves - 1);
  alpha_ = std::clamp(std::tan(std::min(kPi / 2 * root * root, 1.2f)) / 0.644f, 0.02f, 1.0f);
  // Computes the reflection of uniform light.
  scales_.resize(kAngles);
  parallelRanges(kAngles, 1, {}, [&](std::size_t first, std::size_t last) {
    for (std::size_t a = first; a < last; ++a) {
      const float root_of_cosine = static_cast<float>(a) / (kAngles - 1);
      const float cosine = std::max(root_of_cosine * root_of_cosine, kLeastCosine);
      Reflector reflector{.view = {std::sqrt(std::max(1.0f - cosine * cosine, 0.0f)), 0.0f, cosine},
                          .alpha = glm::vec2(alpha_),
                          .specular_share = 0.5f};
      const Sampler sampler(/*seed=*/1, static_cast<std::uint32_t>(a), 0);
      glm::dvec3 sum(0.0);
      for (std::uint32_t i = 0; i < kIntegralPoints; ++i) {
        const glm::vec3 s = reflector.sample(i % 2 == 0 ? 0.0f : 1.0f, sampler.pair(i % 2, i / 2));
        if (s.z > 0.0f) sum += glm::dvec3(unscaled(reflector.view, s) * (s.z / reflector.pdf(s)));
      }
      scales_[a] = std::min(1.0f, static_cast<float>(kIntegralPoints) / largestChannel(glm::vec3(sum)));
    }
  });
}

glm::vec3 MeasuredReflection::unscaled(const glm::vec3& v, const glm::vec3& s) const {
  const glm::dvec2 place = placeOf(glm::dvec3(v), glm::dvec3(s));
  const auto [h, right] = nodeBelow(place.x, kHalves);
  const auto [d, down] = nodeBelow(place.y, kDifferences);
  const glm::vec3* at = &values_[d * kHalves + h];
  return glm::mix(glm::mix(at[0], at[1], right), glm::mix(at[kHalves], at[kHalves + 1], right), down);
}

float MeasuredReflection::scale(float cosine) const {
  const auto [a, share] = nodeBelow(std::sqrt(std::max(cosine, 0.0f)), kAngles);
  return glm::mix(scales_[a], scales_[a + 1], share);
}

glm::vec3 MeasuredReflection::value(const glm::vec3& v, const glm::vec3& s) const {
  return unscaled(v, s) * std::min(scale(v.z), scale(s.z));
}

}  // namespace lambent::baker::reference
