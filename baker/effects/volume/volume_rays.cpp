#include "baker/effects/volume/volume_rays.hpp"

#include <cmath>
#include <numbers>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

SphereTable::SphereTable(std::size_t rays, int order, const glm::dquat& turn)
    : columns_(static_cast<std::size_t>(sh::coefficientCount(order))) {
  directions_.reserve(rays);
  harmonics_.resize(rays * columns_);
  means_.assign(columns_, 0.0);
  std::vector<double> values(columns_);
  for (std::size_t r = 0; r < rays; ++r) {
    const double z = 1.0 - (2.0 * static_cast<double>(r) + 1.0) / static_cast<double>(rays);
    const double phi =
        2.0 * std::numbers::pi * std::fmod(static_cast<double>(r) * (std::numbers::phi - 1.0), 1.0);
    const double across = std::sqrt(1.0 - z * z);
    const glm::dvec3 direction = turn * glm::dvec3(across * std::cos(phi), across * std::sin(phi), z);
    directions_.emplace_back(direction);
    sh::evaluate(order, direction, std::span(values));
    for (std::size_t i = 0; i < columns_; ++i) harmonics_[r * columns_ + i] = static_cast<float>(values[i]);
    for (std::size_t i = 0; i < columns_; ++i) means_[i] += values[i] / static_cast<double>(rays);
  }
}

namespace {

// Computes scale / (4 pi) int f y_i ds of a function f with the mean `mean`, where `lost` are the sums of
// (1 - f) y_i over the table. Losses are taken off the closed form of f = 1 (y_0, then zeros), so that thin
// air is exact; the sums of y_i over the table, which are nearly 0, are corrected for thick air.
void project(const SphereTable& table, double scale, double mean, std::span<const double> lost,
             std::span<float> out) {
  const double share = 1.0 / static_cast<double>(table.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<float>(
        scale * (i == 0 ? kMeanOfBandZero * mean : (1.0 - mean) * table.mean(i) - lost[i] * share));
}

}  // namespace

Arrival FirstLight::look(const glm::vec3& place, const SphereTable& table, std::span<float> transfer,
                         std::span<float> clear) {
  reach_.resize(table.size());
  occluders_.reach(place, table.directions(), reach_);
  lost_.assign(transfer.size(), 0.0);
  gone_.assign(clear.size(), 0.0);
  double met = 0.0, out = 0.0, open = 0.0;
  for (std::size_t r = 0; r < table.size(); ++r) {
    const double depth = double{density_.opticalDepth(place, table.direction(r), reach_[r])};
    const double through = std::exp(-depth), gone = -std::expm1(-depth);
    met += gone;
    out += through;
    const bool blocked = std::isfinite(reach_[r]);
    const double missing = blocked ? 1.0 : gone;
    open += blocked ? 0.0 : through;
    const auto y = table.harmonics(r);
    for (std::size_t i = 0; i < lost_.size(); ++i) lost_[i] += missing * double{y[i]};
    for (std::size_t i = 0; i < gone_.size(); ++i) gone_[i] += gone * double{y[i]};
  }
  const double share = 1.0 / static_cast<double>(table.size());
  const double scale = clear.empty() ? 1.0 : 4.0 * std::numbers::pi;
  project(table, scale, open * share, lost_, transfer);
  project(table, scale, out * share, gone_, clear);
  return {met * share, out * share};
}

}  // namespace lambent::baker
