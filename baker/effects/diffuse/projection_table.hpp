// Spherical harmonics of the shared directions, weighted so that sums over rays are exact where the answer is
// known: with nothing blocked the sum is the closed form (A_l/pi) y_i(n) to float rounding, with everything
// blocked it is 0. Between the two the error is that of the low-discrepancy table alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/transport/direction_table.hpp"

namespace lambent::baker {

class ProjectionTable {
 public:
  // `base` are the weights of the rays as their distribution asks for: cos/pi over the rays' density, sum 1.
  // order 1..8.
  ProjectionTable(const DirectionTable& table, std::span<const double> base, int order);

  // Shadowed transfer in the local frame from the blocked masks of RayScene::trace. out: order² coefficients.
  void project(std::span<const std::uint16_t> blocked, std::span<float> out) const;

  // y_i in the direction of a ray, unweighted.
  std::span<const float> harmonics(std::size_t ray) const {
    return std::span(harmonics_).subspan(ray * columns_, columns_);
  }

  // The weights of the rays: near `base`, all positive. Sum to 1.
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
  std::vector<float> packet_sums_;  // of the sixteen rays of each packet
  std::vector<float> open_;         // the closed form
};

}  // namespace lambent::baker
