// Projects visibility onto the spherical harmonics of the shared directions. Weights make sums over rays
// exact where the answer is known: with nothing blocked the sum is the closed form (A_l/pi) y_i(n) to float
// rounding, with everything blocked it is 0. Between the two the error is that of the low-discrepancy
// directions alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/transport/direction_table.hpp"

namespace lambent::baker {

class ProjectionTable {
 public:
  // `base` are the weights that follow from the distribution of the rays, cos/pi over their density, with the
  // sum 1. The order is 1..8.
  ProjectionTable(const DirectionTable& table, std::span<const double> base, int order);

  // Computes shadowed transfer in the local frame from the blocked masks of RayScene::trace; `out` has order²
  // coefficients.
  void project(std::span<const std::uint16_t> blocked, std::span<float> out) const;

  // Returns y_i in the direction of a ray, unweighted.
  std::span<const float> harmonics(std::size_t ray) const {
    return std::span(harmonics_).subspan(ray * columns_, columns_);
  }

  // Returns the weights of the rays: near `base`, all positive, with the sum 1.
  std::span<const double> weights() const { return weights_; }

 private:
  std::span<const float> row(std::size_t ray) const {
    return std::span(rows_).subspan(ray * columns_, columns_);
  }
  std::span<const float> packetSum(std::size_t p) const {
    return std::span(packet_sums_).subspan(p * columns_, columns_);
  }

  std::size_t columns_;
  std::vector<double> weights_;
  std::vector<float> harmonics_;    // y_i of each ray
  std::vector<float> rows_;         // weight * y_i of each ray
  std::vector<float> packet_sums_;  // weight * y_i, summed over the sixteen rays of each packet
  std::vector<float> open_;         // closed form with nothing blocked
};

}  // namespace lambent::baker
