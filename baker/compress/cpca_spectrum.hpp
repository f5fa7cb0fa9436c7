// Principal components: of a whole cell about zero, which gives the few coordinates in which clusters are
// made, and of one cluster about its mean. Sums are made range by range in order, so results are the same for
// any number of threads; eigenvectors, which have no sign of their own, get one.
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

namespace lambent::baker {

// One column per sample.
using Points = Eigen::MatrixXf;

struct Spectrum {
  Eigen::MatrixXd axes;       // columns, orthonormal, by falling variance
  Eigen::VectorXd variances;  // >= 0
};

// Of a symmetric matrix with eigenvalues >= 0.
Spectrum spectrumOf(const Eigen::MatrixXd& covariance);

// The leading components of E[x xᵀ] about zero, as many as it takes to leave out a mean square of at most
// `tail` (some more may come), all where points are short; but never more than `most` of long ones. Those
// (matrices) by a randomised range finder (Halko, Martinsson, Tropp 2011, algorithm 4.4) with hashed instead
// of random numbers. In `left_out`: the mean square that is in none of the components returned.
Spectrum leadingSpectrum(const Points& points, double tail, Eigen::Index most, double& left_out);

// Of members (one at least) about `centre`, their mean. Where they are fewer than coordinates there are no
// more axes than they span: none whose variance is only rounding.
Spectrum spectrumAbout(const Points& points, std::span<const std::uint32_t> members,
                       const Eigen::VectorXf& centre);

// Mean over `members` (all samples where empty) of x xᵀ; x about `centre` where that is not empty.
Eigen::MatrixXd secondMoment(const Points& points, std::span<const std::uint32_t> members,
                             const Eigen::VectorXf& centre);

}  // namespace lambent::baker
