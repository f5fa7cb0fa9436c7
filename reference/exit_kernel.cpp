#include "reference/exit_kernel.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "reference/sampler.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker::reference {

namespace {

// Assumed radiance of occluders, relative to the sky.
constexpr float kReflected = 0.3f;
// The least height of sampled directions; nearer to the horizon, rounding decides on which side they are.
constexpr float kLeastHeight = 1e-5f;

float total(const glm::vec3& v) {
  return std::abs(v.r) + std::abs(v.g) + std::abs(v.b);
}

void addDiffuse(const glm::vec3& albedo, const glm::vec3& normal, sh::LightVector& kernel) {
  std::array<float, sh::kMaxCoefficients> transfer{};
  sh::unoccludedTransfer(kernel.order, normal, transfer);
  for (std::size_t k = 0; k < kernel.coefficients().size(); ++k) kernel.c[k] += albedo * transfer[k];
}

// A measured BRDF is sampled by two strategies alternately; the density is that of the mixture.
void addSpecular(const Reflector& reflector, std::uint32_t seed, std::uint32_t points,
                 sh::LightVector& kernel) {
  const Sampler sampler(/*seed=*/3, seed, 0);
  Reflector lobe = reflector;
  lobe.specular_share = reflector.measured ? 0.5f : 1.0f;
  std::array<glm::dvec3, sh::kMaxCoefficients> sums{};
  std::array<float, sh::kMaxCoefficients> y{};
  for (std::uint32_t i = 0; i < points; ++i) {
    const bool cosine = reflector.measured && i % 2 == 1;
    const glm::vec2 u = reflector.measured ? sampler.pair(i % 2, i / 2) : sampler.pair(0, i);
    const glm::vec3 s = lobe.sample(cosine ? 1.0f : 0.0f, u);
    const float pdf = lobe.pdf(s);
    if (!(s.z > 0.0f && pdf > 0.0f)) continue;
    const glm::vec3 weight = lobe.specular(s) / pdf;
    sh::evaluate(kernel.order, glm::normalize(lobe.world_from_local * s), y);
    for (std::size_t k = 0; k < kernel.coefficients().size(); ++k) sums[k] += glm::dvec3(weight * y[k]);
  }
  for (std::size_t k = 0; k < kernel.coefficients().size(); ++k)
    kernel.c[k] += glm::vec3(sums[k] / static_cast<double>(points));
}

// Returns the cell of the cumulative `edges` that u falls into, and the position within it.
template <std::size_t N>
std::pair<std::size_t, float> cellOf(const std::array<float, N>& edges, float u) {
  const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, u);
  const auto cell = static_cast<std::size_t>(above - edges.begin()) - 1;
  const float width = edges[cell + 1] - edges[cell];
  return {cell, width > 0.0f ? std::clamp((u - edges[cell]) / width, 0.0f, 1.0f) : 0.5f};
}

template <std::size_t N>
void cumulate(const std::array<float, N>& weights, std::array<float, N + 1>& edges) {
  float sum = 0.0f;
  for (const float weight : weights) sum += weight;
  edges[0] = 0.0f;
  for (std::size_t i = 0; i < N; ++i)
    edges[i + 1] =
        sum > 0.0f ? edges[i] + weights[i] / sum : static_cast<float>(i + 1) / static_cast<float>(N);
  edges[N] = 1.0f;
}

}  // namespace

sh::LightVector exitKernel(const SurfacePoint& point, int order, std::uint32_t seed, std::uint32_t points) {
  sh::LightVector kernel{.order = order};
  addDiffuse(point.glossy ? point.reflector.diffuse : point.albedo, point.shading, kernel);
  if (point.glossy) addSpecular(point.reflector, seed, points, kernel);
  return kernel;
}

FirstHit::FirstHit(const SurfacePoint& point, int order, const sh::LightVector& light, std::uint32_t seed)
    : kernel_(exitKernel(point, order, seed)),
      light_(light),
      horizons_(point.horizons()),
      frame_(frameAbout(point.smooth)) {
  for (std::size_t k = 0; k < kernel_.c.size(); ++k) open_ += kernel_.c[k] * light_.c[k];
  float energy = 0.0f;
  for (const glm::vec3& l : light_.c) energy += glm::dot(l, l) / 3.0f;
  const float brightness =
      energy > 0.0f ? std::sqrt(energy / (4.0f * kPi)) : 1.0f;  // root mean square radiance
  std::array<std::array<float, kColumns>, kRows> weights{};
  float mean = 0.0f;
  for (std::size_t r = 0; r < kRows; ++r)
    for (std::size_t c = 0; c < kColumns; ++c) {
      const glm::vec3 dir =
          directionAt((static_cast<float>(r) + 0.5f) / kRows, (static_cast<float>(c) + 0.5f) / kColumns);
      weights[r][c] = total(skyOfPair(dir)) + kReflected * brightness * total(kernelOfPair(dir));
      mean += weights[r][c] / kCells;
    }
  std::array<float, kRows> row_weights{};
  for (std::size_t r = 0; r < kRows; ++r) {
    for (float& weight : weights[r]) row_weights[r] += weight += 0.1f * mean;  // no weight is 0
    cumulate(weights[r], columns_[r]);
  }
  cumulate(row_weights, rows_);
}

glm::vec3 FirstHit::directionAt(float height, float turn) const {
  const float r = std::sqrt(std::max(0.0f, 1.0f - height * height)), angle = 2.0f * kPi * turn;
  return glm::normalize(frame_ * glm::vec3(r * std::cos(angle), r * std::sin(angle), height));
}

glm::vec3 FirstHit::kernelOfPair(const glm::vec3& dir) const {
  return kernel_.evaluate(dir) + kernel_.evaluate(mirrored(dir));
}

glm::vec3 FirstHit::skyOfPair(const glm::vec3& dir) const {
  const glm::vec3 image = mirrored(dir);
  return kernel_.evaluate(dir) * light_.evaluate(dir) + kernel_.evaluate(image) * light_.evaluate(image);
}

glm::vec3 FirstHit::kernelOfAll(const glm::vec3& ray) const {
  glm::vec3 sum(0.0f);
  horizons_.forAbove(ray, [&](const glm::vec3& dir) { sum += kernelOfPair(dir); });
  return sum;
}

glm::vec3 FirstHit::skyOfAll(const glm::vec3& ray) const {
  glm::vec3 sum(0.0f);
  horizons_.forAbove(ray, [&](const glm::vec3& dir) { sum += skyOfPair(dir); });
  return sum;
}

glm::vec3 FirstHit::sample(const glm::vec2& u) const {
  const auto [r, height] = cellOf(rows_, u.x);
  const auto [c, turn] = cellOf(columns_[r], u.y);
  const glm::vec3 dir = directionAt(std::max((static_cast<float>(r) + height) / kRows, kLeastHeight),
                                    (static_cast<float>(c) + turn) / kColumns);
  return Horizons::above(dir, horizons_.triangle);
}

float FirstHit::pdf(const glm::vec3& ray) const {
  if (!(glm::dot(ray, horizons_.triangle) > 0.0f)) return 0.0f;
  float sum = 0.0f;
  horizons_.forAbove(ray, [&](const glm::vec3& dir) { sum += pdfOfPair(dir); });
  return sum;
}

float FirstHit::pdfOfPair(const glm::vec3& dir) const {
  const glm::vec3 local = dir * frame_;  // the transpose is the inverse
  float turn = std::atan2(local.y, local.x) / (2.0f * kPi);
  if (turn < 0.0f) turn += 1.0f;
  const auto r = std::min(static_cast<std::size_t>(std::max(local.z, 0.0f) * kRows), kRows - 1);
  const auto c = std::min(static_cast<std::size_t>(turn * kColumns), kColumns - 1);
  return (rows_[r + 1] - rows_[r]) * (columns_[r][c + 1] - columns_[r][c]) * kCells / (2.0f * kPi);
}

}  // namespace lambent::baker::reference
