#include "baker/compress/cpca_spectrum.hpp"

#include <vector>

#include <Eigen/Eigenvalues>

#include "baker/work/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr Eigen::Index kBlock = 256;  // samples gathered for one matrix product

}  // namespace

Spectrum spectrumOf(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  Spectrum spectrum{solver.eigenvectors().rowwise().reverse(), solver.eigenvalues().reverse().cwiseMax(0.0)};
  for (Eigen::Index j = 0; j < spectrum.axes.cols(); ++j) {
    Eigen::Index largest = 0;
    spectrum.axes.col(j).cwiseAbs().maxCoeff(&largest);
    if (spectrum.axes(largest, j) < 0.0) spectrum.axes.col(j) *= -1.0;
  }
  return spectrum;
}

Eigen::MatrixXd secondMoment(const Points& points, std::span<const std::uint32_t> members,
                             const Eigen::VectorXf& centre) {
  const Eigen::Index size = points.rows();
  const auto count = members.empty() ? points.cols() : static_cast<Eigen::Index>(members.size());
  // Products of a few hundred samples in float, their sum in double.
  std::vector<Eigen::MatrixXd> partial(static_cast<std::size_t>((count + 8 * kBlock - 1) / (8 * kBlock)));
  parallelRanges(static_cast<std::size_t>(count), 8 * kBlock, {}, [&](std::size_t begin, std::size_t end) {
    Eigen::MatrixXd& sum = partial[begin / (8 * kBlock)];
    sum = Eigen::MatrixXd::Zero(size, size);
    Points block(size, kBlock);
    Eigen::MatrixXf product(size, size);
    for (auto first = static_cast<Eigen::Index>(begin); first < static_cast<Eigen::Index>(end);
         first += kBlock) {
      const Eigen::Index columns = std::min(kBlock, static_cast<Eigen::Index>(end) - first);
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
