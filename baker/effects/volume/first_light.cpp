#include "baker/effects/volume/first_light.hpp"

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

Arrival FirstLight::look(const glm::vec3& place, const SphereTable& table, std::span<float> transfer) {
  const std::size_t columns = transfer.size();
  reach_.resize(table.size());
  occluders_.reach(place, table.directions(), reach_);
  lost_.assign(columns, 0.0);
  double met = 0.0, out = 0.0, open = 0.0;
  for (std::size_t r = 0; r < table.size(); ++r) {
    const double depth = double{density_.opticalDepth(place, table.direction(r), reach_[r])};
    const double clear = std::exp(-depth), gone = -std::expm1(-depth);
    met += gone;
    out += clear;
    const bool blocked = std::isfinite(reach_[r]);
    const double missing = blocked ? 1.0 : gone;
    open += blocked ? 0.0 : clear;
    const auto y = table.harmonics(r);
    for (std::size_t i = 0; i < columns; ++i) lost_[i] += missing * double{y[i]};
  }
  const double share = 1.0 / static_cast<double>(table.size());
  // Losses are taken off the closed form of an open sky (y_0, then zeros), so that thin air is exact. The
  // sums of y_i over the table, which are nearly 0, are corrected for thick air.
  open *= share;
  for (std::size_t i = 0; i < columns; ++i)
    transfer[i] =
        static_cast<float>(i == 0 ? kMeanOfBandZero * open : (1.0 - open) * table.mean(i) - lost_[i] * share);
  return {met * share, out * share};
}

}  // namespace lambent::baker
