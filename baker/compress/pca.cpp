#include "baker/compress/pca.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "baker/compress/light_weights.hpp"
#include "runtime/bundle/transfer_codec.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {
inline namespace single_cluster {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// sqrt(W_i) for every value of a transfer vector.
Vector rootWeights(int order, std::uint32_t channels) {
  const int columns = sh::coefficientCount(order);
  Vector roots(static_cast<Eigen::Index>(channels) * columns);
  for (Eigen::Index i = 0; i < roots.size(); ++i)
    roots(i) = std::sqrt(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i % columns)))]);
  return roots;
}

struct Spectrum {
  Vector mean;       // weighted space
  Matrix axes;       // columns, by falling variance
  Vector variances;  // per sample, >= 0
};

Spectrum analyse(const Matrix& weighted) {  // columns are samples
  Spectrum s;
  s.mean = weighted.rowwise().mean();
  Matrix covariance = Matrix::Zero(weighted.rows(), weighted.rows());
  for (Eigen::Index c = 0; c < weighted.cols(); ++c) {
    const Vector offset = weighted.col(c) - s.mean;
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(offset);
  }
  covariance /= static_cast<double>(weighted.cols());
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(covariance);
  s.axes = solver.eigenvectors().rowwise().reverse();
  s.variances = solver.eigenvalues().reverse().cwiseMax(0.0);
  for (Eigen::Index j = 0; j < s.axes.cols(); ++j) {
    Eigen::Index largest;
    s.axes.col(j).cwiseAbs().maxCoeff(&largest);
    if (s.axes(largest, j) < 0.0) s.axes.col(j) *= -1.0;  // eigenvectors have no sign of their own
  }
  return s;
}

// The step for which uniform quantization of the planes worth keeping has a mean square error of `budget`: a
// plane whose variance is under the quantization noise step²/12 is dropped (reverse water-filling).
double stepFor(const Vector& variances, double budget) {
  const auto error = [&](double step) { return variances.cwiseMin(step * step / 12.0).sum(); };
  double low = 0.0, high = std::sqrt(12.0 * variances.maxCoeff()) + 1e-12;
  if (error(high) <= budget) return high;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (error(middle) <= budget ? low : high) = middle;
  }
  return low;
}

CodedPlane quantize(const Vector& weights, double step) {
  const double low = weights.minCoeff(), range = weights.maxCoeff() - low;
  CodedPlane coded;
  coded.plane.bits = range / step <= 255.0 ? 8 : 16;
  const double levels = coded.plane.bits == 8 ? 255.0 : 65535.0;
  coded.plane.offset = static_cast<float>(low);
  coded.plane.scale = static_cast<float>(std::max(step, range / levels));
  for (const double weight : weights) {
    const double code =
        coded.plane.scale > 0.0f ? std::round((weight - low) / double{coded.plane.scale}) : 0.0;
    coded.codes.push_back(static_cast<std::uint32_t>(std::clamp(code, 0.0, levels)));
  }
  return coded;
}

// Codes with a given step; measures nothing.
CodedTransfer codeWith(const Spectrum& spectrum, const Matrix& weighted, const Vector& roots, double step,
                       Eigen::Index keep) {
  CodedTransfer coded;
  std::vector<float> basis;
  const auto append = [&](const Vector& v) {
    for (Eigen::Index i = 0; i < v.size(); ++i) basis.push_back(static_cast<float>(v(i) / roots(i)));
  };
  append(spectrum.mean);
  const double total = std::max(spectrum.variances.sum(), 1e-300);
  for (Eigen::Index j = 0; j < keep; ++j) {
    append(spectrum.axes.col(j));
    const Vector weights = (weighted.colwise() - spectrum.mean).transpose() * spectrum.axes.col(j);
    coded.planes.push_back(quantize(weights, step));
    coded.planes.back().plane.variance = static_cast<float>(spectrum.variances(j) / total);
  }
  coded.basis = bundle::encodeBasis(basis);
  return coded;
}

std::vector<float> decode(const CodedTransfer& coded, std::size_t count, int order, std::uint32_t channels) {
  bundle::DiffuseTransfer transfer;
  transfer.order = static_cast<std::uint32_t>(order);
  transfer.channels = channels;
  std::vector<std::vector<std::uint32_t>> codes;
  for (const CodedPlane& plane : coded.planes) {
    transfer.planes.push_back(plane.plane);
    codes.push_back(plane.codes);
  }
  const auto basis = bundle::decodeBasis(coded.basis, coded.basis.size() / 2, "basis");
  assert(basis);
  return bundle::decodeTransfer(transfer, static_cast<std::uint32_t>(count), *basis, codes);
}

}  // namespace

double radianceError(std::span<const float> truth, std::span<const float> coded, int order,
                     std::uint32_t channels) {
  const Vector roots = rootWeights(order, channels);
  const auto size = static_cast<std::size_t>(roots.size());
  double error = 0.0, energy = 0.0;
  for (std::size_t at = 0; at < truth.size(); ++at) {
    const double root = roots(static_cast<Eigen::Index>(at % size));
    const double off = root * (double{coded[at]} - double{truth[at]}), value = root * double{truth[at]};
    error += off * off;
    energy += value * value;
  }
  return energy > 0.0 ? std::sqrt(error / energy) : std::sqrt(error);
}

CodedTransfer codeTransfer(std::span<const float> vectors, std::size_t count, int order,
                           std::uint32_t channels, float bound) {
  const Vector roots = rootWeights(order, channels);
  assert(count > 0 && vectors.size() == count * static_cast<std::size_t>(roots.size()) && bound > 0.0f);
  Matrix weighted(roots.size(), static_cast<Eigen::Index>(count));
  for (Eigen::Index s = 0; s < weighted.cols(); ++s)
    for (Eigen::Index i = 0; i < weighted.rows(); ++i)
      weighted(i, s) = roots(i) * double{vectors[static_cast<std::size_t>(s * weighted.rows() + i)]};
  const Spectrum spectrum = analyse(weighted);
  const double energy = weighted.squaredNorm() / static_cast<double>(count);

  // The basis is rounded to half precision after the analysis, so the estimate is checked and tightened if
  // need be.
  double budget = 0.98 * double{bound} * double{bound} * energy;
  CodedTransfer coded;
  for (int attempt = 0; attempt < 12; ++attempt, budget *= 0.7) {
    const double step = std::max(stepFor(spectrum.variances, budget), 1e-9);
    const auto keep = static_cast<Eigen::Index>((spectrum.variances.array() > step * step / 12.0).count());
    coded = codeWith(spectrum, weighted, roots, step, keep);
    coded.error =
        static_cast<float>(radianceError(vectors, decode(coded, count, order, channels), order, channels));
    if (coded.error <= bound) break;
  }
  return coded;
}

}  // namespace single_cluster
}  // namespace lambent::baker
