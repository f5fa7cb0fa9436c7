#include "baker/effects/volume/first_light.hpp"

#include <cmath>

namespace lambent::baker {

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
