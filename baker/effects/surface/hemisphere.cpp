#include "baker/effects/surface/hemisphere.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <glm/vec3.hpp>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

constexpr std::array<double, 3> kCosineOverPi = {1.0, 2.0 / 3.0, 0.25};  // A_l / pi
constexpr std::array<int, 6> kZonalPart = {0, 2, 3, 6, 7, 8};            // (l, m >= 0): 00 10 11 20 21 22

// Returns the kernel at a normal, (A_l/pi) y_j(n').
Vector9 kernelAt(const glm::dvec3& n) {
  Vector9 kernel;
  sh::evaluate<double>(3, n.x, n.y, n.z, std::span(kernel.data(), kIncident));
  for (int j = 0; j < 9; ++j) kernel(j) *= kCosineOverPi[static_cast<std::size_t>(sh::bandOf(j))];
  return kernel;
}

}  // namespace

IncidentBasis::IncidentBasis() {
  // Normals follow a product rule over the upper hemisphere; the integrand is smooth but for the clamp.
  constexpr int kRings = 96, kSpokes = 96;
  Eigen::Matrix<double, 9, 9> gram = Eigen::Matrix<double, 9, 9>::Zero();
  struct Node {
    glm::dvec3 n;
    double weight;
    Vector9 kernel;
  };
  std::vector<Node> nodes;
  for (int r = 0; r < kRings; ++r)
    for (int p = 0; p < kSpokes; ++p) {
      const double z = (r + 0.5) / kRings, phi = 2.0 * std::numbers::pi * (p + 0.5) / kSpokes;
      const double side = std::sqrt(1.0 - z * z);
      Node node{{side * std::cos(phi), side * std::sin(phi), z}, z * z, {}};
      node.kernel = kernelAt(node.n);
      gram += node.weight * node.kernel * node.kernel.transpose();
      nodes.push_back(node);
    }
  // This solves least squares under the constraint kernel(z) · c = s.z / pi; the tenth row is that of its
  // Lagrange multiplier.
  const Vector9 own = kernelAt({0.0, 0.0, 1.0});
  const double scale = gram.trace();
  Eigen::Matrix<double, 10, 10> system = Eigen::Matrix<double, 10, 10>::Zero();
  system.topLeftCorner<9, 9>() = gram / scale;
  system.topRightCorner<9, 1>() = own;
  system.bottomLeftCorner<1, 9>() = own.transpose();
  const Eigen::FullPivLU<Eigen::Matrix<double, 10, 10>> solver(system);
  for (std::size_t step = 0; step <= kSteps; ++step) {
    const double z = static_cast<double>(step) / kSteps;
    const glm::dvec3 s(std::sqrt(std::max(0.0, 1.0 - z * z)), 0.0, z);
    Eigen::Matrix<double, 10, 1> right = Eigen::Matrix<double, 10, 1>::Zero();
    for (const Node& node : nodes) {
      const double cosine = node.n.x * s.x + node.n.z * s.z;
      if (cosine > 0.0) right.head<9>() += (node.weight / scale) * (cosine / std::numbers::pi) * node.kernel;
    }
    right(9) = z / std::numbers::pi;
    const Eigen::Matrix<double, 10, 1> solved = solver.solve(right);
    for (std::size_t k = 0; k < kZonalPart.size(); ++k)
      curves_[step][k] = static_cast<float>(solved(kZonalPart[k]));
  }
}

std::array<float, kIncident> IncidentBasis::evaluate(glm::vec3 s) const {
  const float at = std::clamp(s.z, 0.0f, 1.0f) * static_cast<float>(kSteps);
  const auto step = std::min(static_cast<std::size_t>(at), kSteps - 1);
  const float f = at - static_cast<float>(step);
  std::array<float, 6> c;
  for (std::size_t k = 0; k < c.size(); ++k) c[k] = (1.0f - f) * curves_[step][k] + f * curves_[step + 1][k];
  const float side = std::sqrt(s.x * s.x + s.y * s.y);
  const float cos1 = side > 0.0f ? s.x / side : 1.0f, sin1 = side > 0.0f ? s.y / side : 0.0f;
  const float cos2 = cos1 * cos1 - sin1 * sin1, sin2 = 2.0f * cos1 * sin1;
  // The index is l(l+1)+m; m < 0 stands for the sine.
  return {c[0], sin1 * c[2], c[1], cos1 * c[2], sin2 * c[5], sin1 * c[4], c[3], cos1 * c[4], cos2 * c[5]};
}

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
    for (std::size_t i = 0; i < columns_; ++i)
      packet_sums_[r / kPacketWidth * columns_ + i] += rows_[r * columns_ + i];
}

namespace {

// The smaller side is summed: blocked rays are taken off what nothing blocked would give, or open rays are
// added to nothing. Returns true if it is the blocked ones.
bool fewerAreBlocked(std::span<const std::uint16_t> blocked) {
  int blocked_rays = 0;
  for (const std::uint16_t mask : blocked) blocked_rays += std::popcount(mask);
  return blocked_rays * 2 <= static_cast<int>(blocked.size() * kPacketWidth);
}

// Calls add with the rows of these rays, or with those of whole packets.
template <typename Add>
void addFewer(std::span<const std::uint16_t> blocked, std::span<const float> packet_sums,
              std::span<const float> rows, std::size_t size, const Add& add) {
  const bool of_blocked = fewerAreBlocked(blocked);
  for (std::size_t p = 0; p < blocked.size(); ++p) {
    const auto mask = static_cast<std::uint16_t>(of_blocked ? blocked[p] : ~blocked[p]);
    if (mask == 0xffff)
      add(packet_sums.subspan(p * size, size));
    else
      for (std::uint32_t left = mask; left != 0; left &= left - 1)
        add(rows.subspan((p * kPacketWidth + static_cast<std::size_t>(std::countr_zero(left))) * size, size));
  }
}

}  // namespace

void ProjectionTable::project(std::span<const std::uint16_t> blocked, std::span<float> out) const {
  assert(out.size() == columns_);
  const bool subtract = fewerAreBlocked(blocked);
  if (subtract)
    std::copy(open_.begin(), open_.end(), out.begin());
  else
    std::fill(out.begin(), out.end(), 0.0f);
  addFewer(blocked, packet_sums_, rows_, columns_, [&](std::span<const float> values) {
    if (subtract)
      for (std::size_t i = 0; i < columns_; ++i) out[i] -= values[i];
    else
      for (std::size_t i = 0; i < columns_; ++i) out[i] += values[i];
  });
}

Hemisphere Hemisphere::forNormal(std::size_t rays, int order) {
  Hemisphere hemisphere(cosineTable(rays));
  const std::size_t count = hemisphere.table_.size();
  const std::vector<double> base(count, 1.0 / static_cast<double>(count));
  hemisphere.projection_.emplace(hemisphere.table_, base, order);
  hemisphere.weights_ = hemisphere.projection_->weights();
  hemisphere.rows_.assign(hemisphere.weights_.begin(), hemisphere.weights_.end());
  return hemisphere;
}

Hemisphere Hemisphere::forAnyNormal(std::size_t rays, int order) {
  Hemisphere hemisphere(uniformTable(rays));
  const DirectionTable& table = hemisphere.table_;
  std::vector<double> base(table.z.begin(), table.z.end());  // cos/pi over 1/(2 pi), up to a factor
  const double sum = std::accumulate(base.begin(), base.end(), 0.0);
  for (double& weight : base) weight /= sum;
  hemisphere.projection_.emplace(table, base, order);
  hemisphere.weights_ = hemisphere.projection_->weights();
  hemisphere.basis_.emplace();
  hemisphere.outputs_ = hemisphere.row_size_ = 1 + kIncident;
  hemisphere.indices_.resize(kIncident);
  std::iota(hemisphere.indices_.begin(), hemisphere.indices_.end(), std::uint16_t{0});
  for (std::size_t r = 0; r < table.size(); ++r) {
    // The solid angle of a ray follows from its weight cos/pi dω, so that the nine values give exactly the
    // sample's E/pi at its own normal.
    const double solid_angle = std::numbers::pi * hemisphere.weights_[r] / double{table.z[r]};
    hemisphere.rows_.push_back(static_cast<float>(hemisphere.weights_[r]));
    for (const float value : hemisphere.basis_->evaluate(hemisphere.direction(r)))
      hemisphere.rows_.push_back(static_cast<float>(solid_angle * double{value}));
  }
  return hemisphere;
}

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Returns the number of even harmonics in so many bands.
constexpr std::size_t evenHarmonicCount(int order) {
  return static_cast<std::size_t>(order * (order + 1) / 2);
}

std::vector<std::uint16_t> evenHarmonics(int order) {
  std::vector<std::uint16_t> even;
  for (int l = 0; l < order; ++l)
    for (int m = -l; m <= l; m += 2) even.push_back(static_cast<std::uint16_t>(sh::coefficientIndex(l, m)));
  return even;
}

// Returns weights with the smallest relative change (least squares) of equal weights that makes the
// quadrature of every even harmonic exact: as means over the hemisphere, 1/sqrt(4 pi) for the first and 0 for
// the others. Even harmonics are orthogonal there, so the normal equations are well conditioned. With too few
// rays weights may turn negative; then the highest bands are left inexact, until no weight is negative.
std::vector<double> exactMeanWeights(const Eigen::MatrixXd& even, int order) {
  const Eigen::Index rays = even.cols();
  const double each = 1.0 / static_cast<double>(rays);
  for (int bands = order; bands > 1; --bands) {
    const auto rows = static_cast<Eigen::Index>(evenHarmonicCount(bands));
    const auto basis = even.topRows(rows);
    Eigen::VectorXd wrong = -each * basis.rowwise().sum();
    wrong(0) += 0.5 * std::numbers::inv_sqrtpi;
    const Eigen::MatrixXd gram = each * basis * basis.transpose();
    const Eigen::VectorXd weights =
        each * (Eigen::VectorXd::Ones(rays) + basis.transpose() * gram.ldlt().solve(wrong));
    if (weights.minCoeff() > 0.0) return {weights.begin(), weights.end()};
  }
  return std::vector<double>(static_cast<std::size_t>(rays), each);
}

}  // namespace

Hemisphere Hemisphere::forBrdfs(std::size_t rays, int visibility_bands, int order_out) {
  assert(order_out <= visibility_bands && visibility_bands <= sh::kMaxBasisOrder);
  Hemisphere hemisphere(uniformTable(rays));
  const DirectionTable& table = hemisphere.table_;
  hemisphere.order_out_ = order_out;
  hemisphere.indices_ = evenHarmonics(visibility_bands);
  hemisphere.outputs_ = evenHarmonicCount(order_out);
  const std::size_t size = hemisphere.row_size_ = hemisphere.indices_.size();
  Eigen::MatrixXd even(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(table.size()));
  std::vector<double> all(static_cast<std::size_t>(sh::coefficientCount(visibility_bands)));
  for (std::size_t r = 0; r < table.size(); ++r) {
    sh::evaluate<double>(visibility_bands, double{table.x[r]}, double{table.y[r]}, double{table.z[r]}, all);
    for (std::size_t e = 0; e < size; ++e)
      even(static_cast<Eigen::Index>(e), static_cast<Eigen::Index>(r)) = all[hemisphere.indices_[e]];
  }
  hemisphere.weights_ = exactMeanWeights(even, visibility_bands);
  hemisphere.packet_sums_.assign(table.packets() * size, 0.0f);
  hemisphere.rows_.reserve(table.size() * size);
  for (std::size_t r = 0; r < table.size(); ++r)
    for (std::size_t e = 0; e < size; ++e) {
      const double harmonic = even(static_cast<Eigen::Index>(e), static_cast<Eigen::Index>(r));
      // The factor 2 stands for the ray and its mirror image.
      hemisphere.rows_.push_back(static_cast<float>(2.0 * kTwoPi * hemisphere.weights_[r] * harmonic));
      hemisphere.packet_sums_[r / kPacketWidth * size + e] += hemisphere.rows_.back();
    }
  return hemisphere;
}

float Hemisphere::raysPerSteradian(float cosine) const {
  if (glossy()) return static_cast<float>(static_cast<double>(table_.size()) / kTwoPi);
  const auto rays = static_cast<float>(table_.size());
  return basis_ ? rays / (2.0f * std::numbers::pi_v<float>) : rays * cosine / std::numbers::pi_v<float>;
}

void Hemisphere::incident(glm::vec3 local, std::span<float> out) const {
  if (glossy()) {
    std::vector<float> all(static_cast<std::size_t>(sh::coefficientCount(order_out_)));
    sh::evaluate(order_out_, local, all);
    for (std::size_t e = 0; e < outputs_; ++e) out[e] = 2.0f * all[indices_[e]];
    return;
  }
  out[0] = local.z / std::numbers::pi_v<float>;
  if (basis_) std::ranges::copy(basis_->evaluate(local), out.begin() + 1);
}

void Hemisphere::projectVisibility(std::span<const std::uint16_t> blocked, std::span<const DimmedRay> dimmed,
                                   std::span<float> out) const {
  std::vector<float> sum(row_size_, 0.0f);
  addFewer(blocked, packet_sums_, rows_, row_size_, [&](std::span<const float> values) {
    for (std::size_t e = 0; e < sum.size(); ++e) sum[e] += values[e];
  });
  const bool subtract = fewerAreBlocked(blocked);
  std::fill(out.begin(), out.end(), 0.0f);
  for (std::size_t e = 0; e < sum.size(); ++e) out[indices_[e]] = subtract ? -sum[e] : sum[e];
  if (subtract) out[0] += static_cast<float>(std::sqrt(2.0 * kTwoPi));
  for (const DimmedRay& ray : dimmed)
    for (std::size_t e = 0; e < row_size_; ++e)
      out[indices_[e]] -= (1.0f - meanOf(ray.passed)) * wholeRow(ray.ray)[e];
}

void Hemisphere::turn(const sh::Rotation& group_from_local, std::size_t columns, Rows<const float> local,
                      Rows<float> out) const {
  const auto all = static_cast<std::size_t>(sh::coefficientCount(group_from_local.order()));
  const std::size_t outputs = glossy() ? outputs_ : kIncident;
  std::vector<float> from(all, 0.0f), to(all);
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t o = 0; o < outputs; ++o) from[indices_[o]] = local.values[o * local.stride + column];
    group_from_local.apply(std::span<const float>(from), std::span<float>(to));
    for (std::size_t i = 0; i < all; ++i) out.values[i * out.stride + column] = to[i];
  }
}

}  // namespace lambent::baker
