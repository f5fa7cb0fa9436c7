// Computes principal components: of a whole cell about zero, which gives the few coordinates in which
// clusters are made, and of one cluster about its mean. Sums are made range by range in order, and the sign
// of each eigenvector is fixed, so results are the same for any number of threads.
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

namespace lambent::baker {

// Holds one column per sample.
using Points = Eigen::MatrixXf;

struct Spectrum {
  Eigen::MatrixXd axes;       // columns, orthonormal, by falling variance
  Eigen::VectorXd variances;  // >= 0
};

// Decomposes a symmetric matrix with eigenvalues >= 0.
Spectrum spectrumOf(const Eigen::MatrixXd& covariance);

// Returns the leading components of E[x xᵀ] about zero: as many as it takes to leave out a mean square of at
// most `tail`, or some more. Short points get all components. Long ones (matrices) get at most `most`, by a
// randomised range finder (Halko, Martinsson, Tropp 2011, algorithm 4.4) with hashed instead of random
// numbers. `left_out` receives the mean square that lies in none of the components returned.
Spectrum leadingSpectrum(const Points& points, double tail, Eigen::Index most, double& left_out);

// Analyses `members` (at least one) about their mean, `centre`. If there are fewer members than coordinates,
// only the axes that they span are returned, and none whose variance is only rounding.
Spectrum spectrumAbout(const Points& points, std::span<const std::uint32_t> members,
                       const Eigen::VectorXf& centre);

// Returns the mean over `members` (all samples if empty) of x xᵀ, with x relative to `centre` if that is not
// empty.
Eigen::MatrixXd secondMoment(const Points& points, std::span<const std::uint32_t> members,
                             const Eigen::VectorXf& centre);

}  // namespace lambent::baker
