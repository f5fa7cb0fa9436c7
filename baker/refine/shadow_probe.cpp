#include "baker/refine/shadow_probe.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "baker/compress/light_weights.hpp"
#include "baker/transport/direction_table.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

// The order is that of light and of lobes; visibility matters in all bands that couple the two.
constexpr int kOrder = 5, kVisibilityBands = 2 * kOrder - 1;
constexpr std::size_t kPlainValues = kOrder * kOrder, kGlossyValues = kVisibilityBands * kVisibilityBands;
static_assert(kGlossyValues == ShadowProbe::kMostValues);
// Normals with a larger dot product differ by rounding only.
constexpr float kSameNormal = 1.0f - 1e-6f;

// Adds both halves of the sphere by the points of one, rotated by `turn`.
void addSphere(const DirectionTable& half, const glm::mat3& turn, DirectionTable& table) {
  for (const float sign : {1.0f, -1.0f})
    for (std::size_t i = 0; i < half.size(); ++i) {
      const glm::vec3 d = turn * (sign * glm::vec3(half.x[i], half.y[i], half.z[i]));
      table.x.push_back(d.x), table.y.push_back(d.y), table.z.push_back(d.z);
    }
}

DirectionTable twoSpheres(std::size_t rays) {
  const DirectionTable half = uniformTable(rays / 4);
  DirectionTable table;
  addSphere(half, glm::mat3(1.0f), table);
  // Any rotation will do that brings no axis near another.
  const glm::vec3 a = glm::normalize(glm::vec3(0.46f, 0.71f, 0.53f)),
                  b = glm::normalize(glm::cross(a, glm::vec3(0.8f, -0.1f, 0.6f)));
  addSphere(half, glm::mat3(b, glm::cross(a, b), a), table);
  return table;
}

// Returns weights for errors of irradiance by the power of light in each band, relative to an open point.
std::vector<double> irradianceRoots() {
  double open = 0.0;
  for (int l = 0; l < kOrder; ++l) {
    const double cosine = sh::clampedCosine(l) / std::numbers::pi;
    open +=
        kBandPower[static_cast<std::size_t>(l)] * cosine * cosine * (2 * l + 1) / (4.0 * std::numbers::pi);
  }
  std::vector<double> roots;
  for (std::size_t i = 0; i < kPlainValues; ++i)
    roots.push_back(std::sqrt(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))] / open));
  return roots;
}

// Returns weights for errors of visibility by how its products with lights show in lobes (CodingSettings),
// also relative to an open point.
std::vector<double> visibilityRoots() {
  const sh::GauntTable table = sh::makeGauntTable(kOrder, kOrder);
  std::vector<double> roots(kGlossyValues, 0.0);
  double open = 0.0;
  for (std::size_t i = 0; i < kPlainValues; ++i) {
    const auto band = static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)));
    open += kLobePower[band] * kBandPower[band];
    for (std::uint32_t t = table.offsets[i]; t < table.offsets[i + 1]; ++t) {
      const sh::GauntTerm& term = table.terms[t];
      roots[term.k] += kLobePower[band] * kBandPower[static_cast<std::size_t>(sh::bandOf(term.j))] *
                       double{term.value} * double{term.value};
    }
  }
  for (double& root : roots) root = std::sqrt(root / open);
  return roots;
}

}  // namespace

ShadowProbe::ShadowProbe(std::size_t rays) : directions_(twoSpheres(rays)) {
  const std::vector<double> irradiance = irradianceRoots(), visibility = visibilityRoots();
  const double solid_angle = 8.0 * std::numbers::pi / static_cast<double>(directions_.size());  // of one half
  std::vector<double> basis(kGlossyValues);
  for (std::size_t r = 0; r < directions_.size(); ++r) {
    sh::evaluate<double>(kVisibilityBands, double{directions_.x[r]}, double{directions_.y[r]},
                         double{directions_.z[r]}, basis);
    for (std::size_t i = 0; i < kPlainValues; ++i)
      irradiance_.push_back(static_cast<float>(irradiance[i] * basis[i] * solid_angle / std::numbers::pi));
    for (std::size_t i = 0; i < kGlossyValues; ++i)
      visibility_.push_back(static_cast<float>(visibility[i] * basis[i] * solid_angle));
  }
}

std::span<const float> ShadowProbe::row(std::size_t direction, bool plain) const {
  return plain ? std::span(irradiance_).subspan(direction * kPlainValues, kPlainValues)
               : std::span(visibility_).subspan(direction * kGlossyValues, kGlossyValues);
}

bool ShadowProbe::look(const RayScene& scene, std::span<const SampleOrigin> origins, const glm::vec3& normal,
                       SampleKind kind, std::span<std::uint16_t> masks) const {
  std::fill(masks.begin(), masks.end(), std::uint16_t{0});
  SeenOrigins seen;
  findSeenOrigins(origins, glm::mat3(localFrame(glm::normalize(glm::dvec3(normal)))), scene, inside_test_,
                  seen);
  if (!seen.valid) return false;
  if (kind == SampleKind::Diffuse) {
    scene.trace({seen.origins, glm::mat3(1.0f), directions_, BelowHorizon::Blocked}, masks);
    return true;
  }
  DirectionTable above = directions_;
  for (std::size_t r = 0; r < above.size(); ++r) {
    const float height = above.x[r] * normal.x + above.y[r] * normal.y + above.z[r] * normal.z;
    if (height >= 0.0f) continue;
    above.x[r] -= 2.0f * height * normal.x;
    above.y[r] -= 2.0f * height * normal.y;
    above.z[r] -= 2.0f * height * normal.z;
  }
  scene.trace({seen.origins, glm::mat3(1.0f), above, BelowHorizon::Mirrored}, masks);
  return true;
}

ShadowProbe::Difference ShadowProbe::difference(std::span<const HiddenFrom, 3> corners,
                                                const HiddenFrom& truth, SampleKind kind) const {
  const bool plain = kind == SampleKind::Diffuse;
  const bool cosines_differ = plain && std::ranges::any_of(corners, [&](const HiddenFrom& corner) {
                                return glm::dot(corner.normal, truth.normal) < kSameNormal;
                              });
  Difference wrong{};
  for (std::size_t p = 0; p < packets(); ++p) {
    const unsigned in_any = corners[0].masks[p] | corners[1].masks[p] | corners[2].masks[p] | truth.masks[p],
                   in_all = corners[0].masks[p] & corners[1].masks[p] & corners[2].masks[p] & truth.masks[p];
    // What is hidden from all of them makes no difference, unless their cosines differ.
    for (unsigned left = cosines_differ ? in_any : in_any & ~in_all; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      const std::size_t r = p * kPacketWidth + k;
      const glm::vec3 direction(directions_.x[r], directions_.y[r], directions_.z[r]);
      const auto hidden = [&](const HiddenFrom& point) {
        if ((point.masks[p] >> k & 1) == 0) return 0.0f;
        return plain ? std::max(0.0f, glm::dot(point.normal, direction)) : 1.0f;
      };
      float off = -hidden(truth);
      for (const HiddenFrom& corner : corners) off += corner.share * hidden(corner);
      if (off == 0.0f) continue;
      const std::span<const float> from = row(r, plain);
      auto& to = wrong[r < directions_.size() / 2 ? 0 : 1];
      for (std::size_t i = 0; i < from.size(); ++i) to[i] += off * from[i];
    }
  }
  return wrong;
}

ShadowProbe::Difference ShadowProbe::arriving(const HiddenFrom& point, SampleKind kind) const {
  const bool plain = kind == SampleKind::Diffuse;
  Difference light{};
  for (std::size_t r = 0; r < directions_.size(); ++r) {
    if ((point.masks[r / kPacketWidth] >> r % kPacketWidth & 1) != 0) continue;
    const glm::vec3 direction(directions_.x[r], directions_.y[r], directions_.z[r]);
    const float seen = plain ? glm::dot(point.normal, direction) : 1.0f;
    if (!(seen > 0.0f)) continue;
    const std::span<const float> from = row(r, plain);
    auto& to = light[r < directions_.size() / 2 ? 0 : 1];
    for (std::size_t i = 0; i < from.size(); ++i) to[i] += seen * from[i];
  }
  return light;
}

double ShadowProbe::squareError(const Difference& difference) {
  double error = 0.0;
  for (std::size_t i = 0; i < kMostValues; ++i) error += double{difference[0][i]} * double{difference[1][i]};
  return error;
}

float ShadowProbe::openShare(const HiddenFrom& point) const {
  float sum = 0.0f;
  for (std::size_t r = 0; r < directions_.size(); ++r)
    if ((point.masks[r / kPacketWidth] >> r % kPacketWidth & 1) == 0)
      sum += std::max(
          0.0f, glm::dot(point.normal, glm::vec3(directions_.x[r], directions_.y[r], directions_.z[r])));
  return 4.0f * sum /
         static_cast<float>(directions_.size());  // the mean over a sphere of an open point is 1/4
}

}  // namespace lambent::baker
