#include "baker/compress/cpca_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr Eigen::Index kSpectrumBlock = 256;  // samples gathered for one matrix product
constexpr Eigen::Index kShortPoints = 320;    // up to this length all components cost little
// Components looked for at first, then doubled until they are enough.
constexpr Eigen::Index kFirstSketch = 64;
constexpr double kOnlyRounding = 1e-12;  // relative to the largest variance; points are floats

// Returns a number with mean 0 and variance 1 from a counter (splitmix64). Two-valued numbers sketch as well
// as normal ones.
float sign(std::uint64_t counter) {
  std::uint64_t z = (counter + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ z >> 27) * 0x94d049bb133111ebull;
  return (z ^ z >> 31) & 1 ? 1.0f : -1.0f;
}

// Returns E[x xᵀ] times a few columns. Ranges are added in order, so the result is the same for any number of
// threads.
Eigen::MatrixXf covarianceTimes(const Points& points, const Eigen::MatrixXf& columns) {
  constexpr std::size_t kGrain = 1024;
  const auto count = static_cast<std::size_t>(points.cols());
  std::vector<Eigen::MatrixXf> partial((count + kGrain - 1) / kGrain);
  parallelRanges(count, kGrain, {}, [&](std::size_t begin, std::size_t end) {
    const auto block =
        points.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin));
    const Eigen::MatrixXf inner = block.transpose() * columns;
    partial[begin / kGrain].noalias() = block * inner;
  });
  Eigen::MatrixXf sum = Eigen::MatrixXf::Zero(points.rows(), columns.cols());
  for (const Eigen::MatrixXf& part : partial) sum += part;
  return sum / static_cast<float>(count);
}

Eigen::MatrixXf orthonormal(const Eigen::MatrixXf& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXf> qr(columns);
  return qr.householderQ() * Eigen::MatrixXf::Identity(columns.rows(), columns.cols());
}

// Makes the largest coordinate of each axis positive.
void setSigns(Eigen::MatrixXd& axes) {
  for (Eigen::Index j = 0; j < axes.cols(); ++j) {
    Eigen::Index largest = 0;
    axes.col(j).cwiseAbs().maxCoeff(&largest);
    if (axes(largest, j) < 0.0) axes.col(j) *= -1.0;
  }
}

}  // namespace

Spectrum leadingSpectrum(const Points& points, double tail, Eigen::Index most, double& left_out) {
  double energy = 0.0;
  for (Eigen::Index s = 0; s < points.cols(); ++s) energy += points.col(s).cast<double>().squaredNorm();
  energy /= static_cast<double>(points.cols());
  for (Eigen::Index width = std::min(kFirstSketch, most);
       points.rows() > kShortPoints && (width < points.rows() / 2 || width == most);
       width = std::min(2 * width, most)) {
    Eigen::MatrixXf sketch(points.rows(), width);
    for (Eigen::Index i = 0; i < sketch.size(); ++i) sketch.data()[i] = sign(static_cast<std::uint64_t>(i));
    // One power iteration more than the range needs brings out the components that matter little, too.
    const Eigen::MatrixXf range =
        orthonormal(covarianceTimes(points, orthonormal(covarianceTimes(points, sketch))));
    const Points inside = range.transpose() * points;
    Spectrum found = spectrumOf(secondMoment(inside, {}, {}));
    left_out = std::max(0.0, energy - found.variances.sum());
    // The last components found are inaccurate.
    if (width < most && left_out + found.variances.tail(width / 8).sum() > tail) continue;
    found.axes = range.cast<double>() * found.axes;
    return found;
  }
  left_out = 0.0;
  return spectrumOf(secondMoment(points, {}, {}));
}

Spectrum spectrumOf(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  Spectrum spectrum{solver.eigenvectors().rowwise().reverse(), solver.eigenvalues().reverse().cwiseMax(0.0)};
  setSigns(spectrum.axes);
  return spectrum;
}

Spectrum spectrumAbout(const Points& points, std::span<const std::uint32_t> members,
                       const Eigen::VectorXf& centre) {
  const auto count = static_cast<Eigen::Index>(members.size());
  if (count >= points.rows()) return spectrumOf(secondMoment(points, members, centre));
  // With x/sqrt(count) as columns of X, X Xᵀ and the smaller Xᵀ X have the same nonzero eigenvalues, and if v
  // is an eigenvector of the second, X v is one of the first.
  Eigen::MatrixXd own(points.rows(), count);
  for (Eigen::Index m = 0; m < count; ++m)
    own.col(m) = (points.col(members[static_cast<std::size_t>(m)]) - centre).cast<double>();
  own /= std::sqrt(static_cast<double>(count));
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
  products.selfadjointView<Eigen::Lower>().rankUpdate(own.transpose());
  Spectrum spectrum = spectrumOf(products.selfadjointView<Eigen::Lower>());
  Eigen::Index some = 0;
  while (some < count && spectrum.variances(some) > kOnlyRounding * spectrum.variances(0)) ++some;
  spectrum.variances.conservativeResize(some);
  spectrum.axes = own * spectrum.axes.leftCols(some);
  spectrum.axes.colwise().normalize();
  setSigns(spectrum.axes);
  return spectrum;
}

Eigen::MatrixXd secondMoment(const Points& points, std::span<const std::uint32_t> members,
                             const Eigen::VectorXf& centre) {
  const Eigen::Index size = points.rows();
  const auto count = members.empty() ? points.cols() : static_cast<Eigen::Index>(members.size());
  // Products of a few hundred samples are in float, their sum in double.
  std::vector<Eigen::MatrixXd> partial(
      static_cast<std::size_t>((count + 8 * kSpectrumBlock - 1) / (8 * kSpectrumBlock)));
  parallelRanges(
      static_cast<std::size_t>(count), 8 * kSpectrumBlock, {}, [&](std::size_t begin, std::size_t end) {
        Eigen::MatrixXd& sum = partial[begin / (8 * kSpectrumBlock)];
        sum = Eigen::MatrixXd::Zero(size, size);
        Points block(size, kSpectrumBlock);
        Eigen::MatrixXf product(size, size);
        for (auto first = static_cast<Eigen::Index>(begin); first < static_cast<Eigen::Index>(end);
             first += kSpectrumBlock) {
          const Eigen::Index columns = std::min(kSpectrumBlock, static_cast<Eigen::Index>(end) - first);
          for (Eigen::Index c = 0; c < columns; ++c) {
            const Eigen::Index sample =
                members.empty() ? first + c : Eigen::Index{members[static_cast<std::size_t>(first + c)]};
            block.col(c) = points.col(sample);
            if (centre.size() > 0) block.col(c) -= centre;
          }
          product.setZero();
          product.selfadjointView<Eigen::Lower>().rankUpdate(block.leftCols(columns));
          sum.triangularView<Eigen::Lower>() += product.cast<double>();
        }
      });
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(size, size);
  for (const Eigen::MatrixXd& sum : partial) total += sum;
  total /= static_cast<double>(count);
  return total.selfadjointView<Eigen::Lower>();
}

}  // namespace lambent::baker
