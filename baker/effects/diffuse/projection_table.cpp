#include "baker/effects/diffuse/projection_table.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

#include <Eigen/SVD>
#include <glm/vec3.hpp>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

// Returns weights with the smallest relative change (least squares) of the base weights that makes the
// quadrature of every y_i max(z, 0)/pi exact. Harmonics are nearly dependent on a hemisphere, hence the
// rank-revealing solver. If there are few rays for the order, exact weights may turn negative, and uniform
// light could come out above the albedo. Then the combinations of harmonics that the hemisphere hardly shows
// are left to the base weights, more of them until every weight is positive.
Eigen::VectorXd exactWeights(const Eigen::MatrixXd& basis, const Eigen::VectorXd& base,
                             const Eigen::VectorXd& exact) {
  const Eigen::Index rays = basis.cols();
  const Eigen::MatrixXd weighted = basis * base.asDiagonal();
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(weighted, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd residual = svd.matrixU().transpose() * (exact - basis * base);
  for (double threshold = 1e-10;; threshold *= 10.0) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(rays);
    for (Eigen::Index i = 0; i < residual.size(); ++i)
      if (svd.singularValues()(i) > threshold * svd.singularValues()(0))
        change += residual(i) / svd.singularValues()(i) * svd.matrixV().col(i);
    const Eigen::VectorXd weights = base.cwiseProduct(Eigen::VectorXd::Ones(rays) + change);
    if (weights.minCoeff() > 0.0) return weights / weights.sum();
  }
}

}  // namespace

ProjectionTable::ProjectionTable(const DirectionTable& table, std::span<const double> base, int order)
    : columns_(static_cast<std::size_t>(sh::coefficientCount(order))) {
  const auto rays = static_cast<Eigen::Index>(table.size());
  const auto columns = static_cast<Eigen::Index>(columns_);
  Eigen::MatrixXd basis(columns, rays);
  for (Eigen::Index r = 0; r < rays; ++r) {
    const auto i = static_cast<std::size_t>(r);
    sh::evaluate<double>(order, double{table.x[i]}, double{table.y[i]}, double{table.z[i]},
                         std::span(basis.col(r).data(), columns_));
  }
  Eigen::VectorXd exact(columns);
  sh::unoccludedTransfer(order, glm::dvec3(0.0, 0.0, 1.0), std::span(exact.data(), columns_));
  const Eigen::VectorXd weights =
      exactWeights(basis, Eigen::Map<const Eigen::VectorXd>(base.data(), rays), exact);
  weights_.assign(weights.begin(), weights.end());

  packet_sums_.assign(table.packets() * columns_, 0.0f);
  for (Eigen::Index i = 0; i < columns; ++i) open_.push_back(static_cast<float>(exact(i)));
  for (Eigen::Index r = 0; r < rays; ++r)
    for (Eigen::Index i = 0; i < columns; ++i) {
      harmonics_.push_back(static_cast<float>(basis(i, r)));
      rows_.push_back(static_cast<float>(weights(r) * basis(i, r)));
    }
  for (std::size_t r = 0; r < table.size(); ++r)
    for (std::size_t i = 0; i < columns_; ++i) packet_sums_[r / kPacketWidth * columns_ + i] += row(r)[i];
}

void ProjectionTable::project(std::span<const std::uint16_t> blocked, std::span<float> out) const {
  assert(out.size() == columns_);
  int blocked_rays = 0;
  for (const std::uint16_t mask : blocked) blocked_rays += std::popcount(mask);
  // The smaller side is summed: blocked rays are taken off the closed form, or open rays are added to
  // nothing.
  const bool subtract = blocked_rays * 2 <= static_cast<int>(blocked.size() * kPacketWidth);
  if (subtract)
    std::copy(open_.begin(), open_.end(), out.begin());
  else
    std::fill(out.begin(), out.end(), 0.0f);

  const auto add = [&](std::span<const float> values) {
    if (subtract)
      for (std::size_t i = 0; i < columns_; ++i) out[i] -= values[i];
    else
      for (std::size_t i = 0; i < columns_; ++i) out[i] += values[i];
  };
  for (std::size_t p = 0; p < blocked.size(); ++p) {
    const auto mask = static_cast<std::uint16_t>(subtract ? blocked[p] : ~blocked[p]);
    if (mask == 0xffff)
      add(packetSum(p));
    else
      for (std::uint32_t left = mask; left != 0; left &= left - 1)
        add(row(p * kPacketWidth + static_cast<std::size_t>(std::countr_zero(left))));
  }
}

}  // namespace lambent::baker
