#include "baker/refine/shadow_probe.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "baker/compress/light_weights.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

// Both halves of the sphere by the points of one.
DirectionTable sphereTable(std::size_t rays) {
  DirectionTable table = uniformTable(rays / 2);
  const std::size_t half = table.size();
  for (std::size_t i = 0; i < half; ++i) {
    table.x.push_back(-table.x[i]);
    table.y.push_back(-table.y[i]);
    table.z.push_back(-table.z[i]);
  }
  return table;
}

using Roots = std::array<double, kShadowOrder * kShadowOrder>;

// Errors of irradiance by the power of light in each band, relative to an open point's.
Roots irradianceRoots() {
  double open = 0.0;
  for (int l = 0; l < kShadowOrder; ++l) {
    const double cosine = sh::clampedCosine(l) / std::numbers::pi;
    open +=
        kBandPower[static_cast<std::size_t>(l)] * cosine * cosine * (2 * l + 1) / (4.0 * std::numbers::pi);
  }
  Roots roots{};
  for (std::size_t i = 0; i < roots.size(); ++i)
    roots[i] = std::sqrt(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))] / open);
  return roots;
}

// Errors of visibility by what its products with lights show to lobes (CodingSettings), likewise.
Roots visibilityRoots() {
  const sh::GauntTable table = sh::makeGauntTable(kShadowOrder, kShadowOrder);
  Roots powers{};
  double open = 0.0;
  for (std::size_t i = 0; i < powers.size(); ++i) {
    const auto band = static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)));
    open += kLobePower[band] * kBandPower[band];
    for (std::uint32_t t = table.offsets[i]; t < table.offsets[i + 1]; ++t) {
      const sh::GauntTerm& term = table.terms[t];
      if (term.k < powers.size())
        powers[term.k] += kLobePower[band] * kBandPower[static_cast<std::size_t>(sh::bandOf(term.j))] *
                          double{term.value} * double{term.value};
    }
  }
  Roots roots{};
  for (std::size_t k = 0; k < roots.size(); ++k) roots[k] = std::sqrt(powers[k] / open);
  return roots;
}

}  // namespace

ShadowProbe::ShadowProbe(std::size_t rays) : directions_(sphereTable(rays)) {
  const Roots irradiance = irradianceRoots(), visibility = visibilityRoots();
  const double solid_angle = 4.0 * std::numbers::pi / static_cast<double>(directions_.size());
  for (std::size_t r = 0; r < directions_.size(); ++r) {
    std::array<double, kShadowOrder * kShadowOrder> basis;
    sh::evaluate(kShadowOrder, glm::dvec3(directions_.x[r], directions_.y[r], directions_.z[r]), basis);
    Shadow of_irradiance, of_visibility;
    for (std::size_t i = 0; i < basis.size(); ++i) {
      of_irradiance[i] = static_cast<float>(irradiance[i] * basis[i] * solid_angle / std::numbers::pi);
      of_visibility[i] = static_cast<float>(visibility[i] * basis[i] * solid_angle);
    }
    irradiance_.push_back(of_irradiance);
    visibility_.push_back(of_visibility);
  }
}

Shadow ShadowProbe::at(const RayScene& scene, std::span<const SampleOrigin> origins, const glm::vec3& normal,
                       SampleKind kind) const {
  Shadow shadow{};
  if (origins.empty()) return shadow;
  const bool plain = kind == SampleKind::Plain;
  std::vector<std::uint16_t> masks(directions_.packets());
  scene.trace(origins, glm::mat3(1.0f), directions_, masks,
              plain ? BelowHorizon::Blocked : BelowHorizon::Mirrored);
  for (std::size_t p = 0; p < masks.size(); ++p) {
    if (masks[p] == 0) continue;
    for (std::size_t k = 0; k < kPacketWidth; ++k) {
      if ((masks[p] >> k & 1) == 0) continue;
      const std::size_t r = p * kPacketWidth + k;
      float weight = 1.0f;
      if (plain)
        weight =
            std::max(0.0f, glm::dot(normal, glm::vec3(directions_.x[r], directions_.y[r], directions_.z[r])));
      const Shadow& row = plain ? irradiance_[r] : visibility_[r];
      for (std::size_t i = 0; i < shadow.size(); ++i) shadow[i] += weight * row[i];
    }
  }
  return shadow;
}

}  // namespace lambent::baker
