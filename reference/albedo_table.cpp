#include "reference/albedo_table.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "baker/jobs/parallel.hpp"
#include "reference/brdf.hpp"
#include "reference/sampler.hpp"
#include "reference/warp.hpp"

namespace lambent::baker::reference {

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
