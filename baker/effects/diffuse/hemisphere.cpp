#include "baker/effects/diffuse/hemisphere.hpp"

#include <numbers>
#include <numeric>
#include <utility>

namespace lambent::baker {

Hemisphere::Hemisphere(DirectionTable table, const std::vector<double>& base, int order)
    : table_(std::move(table)), projection_(table_, base, order) {}

Hemisphere Hemisphere::forNormal(std::size_t rays, int order) {
  DirectionTable table = cosineTable(rays);
  const std::vector<double> base(table.size(), 1.0 / static_cast<double>(table.size()));
  return Hemisphere(std::move(table), base, order);
}

Hemisphere Hemisphere::forAnyNormal(std::size_t rays, int order) {
  DirectionTable table = uniformTable(rays);
  std::vector<double> base(table.z.begin(), table.z.end());  // cos/pi over 1/(2 pi), up to a factor
  const double sum = std::accumulate(base.begin(), base.end(), 0.0);
  for (double& weight : base) weight /= sum;
  Hemisphere hemisphere(std::move(table), base, order);
  hemisphere.basis_.emplace();
  for (std::size_t r = 0; r < hemisphere.table_.size(); ++r) {
    // The solid angle of a ray follows from its weight cos/pi dω, so that the nine values give exactly the
    // sample's E/pi at its own normal.
    const double cosine = double{hemisphere.table_.z[r]};
    const double solid_angle = std::numbers::pi * hemisphere.weight(r) / cosine;
    auto weights = hemisphere.basis_->evaluate(hemisphere.direction(r));
    for (float& weight : weights) weight = static_cast<float>(solid_angle * double{weight});
    hemisphere.incident_.push_back(weights);
  }
  return hemisphere;
}

float Hemisphere::raysPerSteradian(float cosine) const {
  const auto rays = static_cast<float>(table_.size());
  return hasIncident() ? rays / (2.0f * std::numbers::pi_v<float>)
                       : rays * cosine / std::numbers::pi_v<float>;
}

}  // namespace lambent::baker
