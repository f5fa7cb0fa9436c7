#include "baker/effects/glossy/glossy_transport.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// Keeps the first `to` of each `from` values in a row, in place.
void keepFirst(std::size_t from, std::size_t to, std::vector<float>& values) {
  assert(to <= from);
  if (values.empty() || from == to) return;
  const std::size_t rows = values.size() / from;
  for (std::size_t row = 0; row < rows; ++row)
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row * from), to,
                values.begin() + static_cast<std::ptrdiff_t>(row * to));
  values.resize(rows * to);
  values.shrink_to_fit();
}

}  // namespace

void GlossyField::keepBands(int order) {
  const std::size_t seen = visibilitySize(),
                    outputs = static_cast<std::size_t>(order_out) * static_cast<std::size_t>(order_out),
                    kept = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
  order_out = order;
  keepFirst(seen, visibilitySize(), visibility);
  keepFirst(outputs * light_columns, kept * light_columns, lights_shadowed);
}

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

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
std::vector<double> exactWeights(const Eigen::MatrixXd& even, int order) {
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

GlossyHemisphere::GlossyHemisphere(std::size_t rays, int visibility_bands, int order_out)
    : table_(uniformTable(rays)),
      order_out_(order_out),
      even_(evenHarmonics(visibility_bands)),
      even_outputs_(evenHarmonicCount(order_out)) {
  assert(order_out <= visibility_bands && visibility_bands <= sh::kMaxBasisOrder);
  Eigen::MatrixXd even(static_cast<Eigen::Index>(even_.size()), static_cast<Eigen::Index>(table_.size()));
  std::vector<double> all(static_cast<std::size_t>(sh::coefficientCount(visibility_bands)));
  for (std::size_t r = 0; r < table_.size(); ++r) {
    sh::evaluate<double>(visibility_bands, double{table_.x[r]}, double{table_.y[r]}, double{table_.z[r]},
                         all);
    for (std::size_t e = 0; e < even_.size(); ++e)
      even(static_cast<Eigen::Index>(e), static_cast<Eigen::Index>(r)) = all[even_[e]];
  }
  weights_ = exactWeights(even, visibility_bands);
  packet_sums_.assign(table_.packets() * even_.size(), 0.0f);
  rows_.reserve(table_.size() * even_.size());
  for (std::size_t r = 0; r < table_.size(); ++r)
    for (std::size_t e = 0; e < even_.size(); ++e) {
      const double harmonic = even(static_cast<Eigen::Index>(e), static_cast<Eigen::Index>(r));
      // The factor 2 stands for the ray and its mirror image.
      rows_.push_back(static_cast<float>(2.0 * kTwoPi * weights_[r] * harmonic));
      packet_sums_[r / kPacketWidth * even_.size() + e] += rows_.back();
    }
}

float GlossyHemisphere::raysPerSteradian() const {
  return static_cast<float>(static_cast<double>(table_.size()) / kTwoPi);
}

void GlossyHemisphere::incident(glm::vec3 local, std::span<float> out) const {
  std::vector<float> all(static_cast<std::size_t>(sh::coefficientCount(order_out_)));
  sh::evaluate(order_out_, local, all);
  for (std::size_t e = 0; e < even_outputs_; ++e) out[e] = 2.0f * all[even_[e]];
}

void GlossyHemisphere::project(std::span<const std::uint16_t> blocked, std::span<const DimmedRay> dimmed,
                               std::span<float> out) const {
  int blocked_rays = 0;
  for (const std::uint16_t mask : blocked) blocked_rays += std::popcount(mask);
  // The smaller side is summed: blocked rays are taken off 1, or open rays are added to nothing.
  const bool subtract = blocked_rays * 2 <= static_cast<int>(blocked.size() * kPacketWidth);
  std::vector<float> sum(even_.size(), 0.0f);
  const auto add = [&](const float* values) {
    for (std::size_t e = 0; e < sum.size(); ++e) sum[e] += values[e];
  };
  for (std::size_t p = 0; p < blocked.size(); ++p) {
    const auto mask = static_cast<std::uint16_t>(subtract ? blocked[p] : ~blocked[p]);
    if (mask == 0xffff)
      add(packet_sums_.data() + p * even_.size());
    else
      for (std::uint32_t left = mask; left != 0; left &= left - 1)
        add(row(p * kPacketWidth + static_cast<std::size_t>(std::countr_zero(left))).data());
  }
  std::fill(out.begin(), out.end(), 0.0f);
  for (std::size_t e = 0; e < sum.size(); ++e) out[even_[e]] = subtract ? -sum[e] : sum[e];
  if (subtract) out[0] += static_cast<float>(std::sqrt(2.0 * kTwoPi));
  for (const DimmedRay& ray : dimmed)
    for (std::size_t e = 0; e < even_.size(); ++e)
      out[even_[e]] -= (1.0f - meanOf(ray.passed)) * row(ray.ray)[e];
}

void turnOutputs(const sh::Rotation& group_from_local, std::span<const std::uint16_t> even,
                 std::size_t columns, Rows<const float> local, Rows<float> out) {
  const auto outputs = static_cast<std::size_t>(sh::coefficientCount(group_from_local.order()));
  std::vector<float> from(outputs, 0.0f), to(outputs);
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t e = 0; e < even.size(); ++e) from[even[e]] = local.values[e * local.stride + column];
    group_from_local.apply(std::span<const float>(from), std::span<float>(to));
    for (std::size_t i = 0; i < outputs; ++i) out.values[i * out.stride + column] = to[i];
  }
}

}  // namespace lambent::baker
