// Finds clusters of samples that lie near common affine subspaces (Sloan 2003, section 4.2: iterative PCA). A
// sample belongs where it costs least, in error and bits together: an axis costs bits for each sample and in
// the codebook, and a cluster costs bits for its id. The quantization step of the weights makes error and
// bits comparable: one more bit on a weight lowers its square error of step²/12 to a quarter, so at the
// margin a bit is worth 2 ln 2 step²/12.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "baker/compress/cpca.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::baker {

// The space in which coding errors are measured. If a transfer vector is scaled value by value with roots[i],
// the squares of its errors add up to the relative square error of shaded radiance. The energy of each block
// of the cell (shadowed light, full light) is 1 in this space, so that one number bounds both. The measure of
// coded vectors, radianceError, is implemented here too.

// Returns how much the square error of each sample counts: 1 / (ε + x), x being the sample's brightness
// relative to the RMS of all, scaled so that the energy of all samples together stays what it is. An eye that
// has adapted to a room sees errors relative to what is there, and not to what stands in the window. It is 1
// for parts that are shown together with others (CodingSettings::shown_energy, visibility), since the
// brightness of one part says too little. `weights` multiply it, unless they are empty
// (CodingSettings::weights).
std::vector<float> sampleImportance(std::span<const float> vectors, const transfer::TransferShape& shape,
                                    double shown_energy, const BandPower& kernel_power,
                                    std::span<const float> weights);

struct WeightedSpace {
  std::vector<double> roots;  // one per value of a vector; 0 where the cell has no energy
  double blocks = 1.0;        // sum of the energies of all blocks, weighted as in `roots`
};

// `shown_energy` and `kernel_power` are as in CodingSettings.
WeightedSpace weightedSpace(std::span<const float> vectors, const transfer::TransferShape& shape,
                            double shown_energy, const BandPower& kernel_power);

// This is the weight of errors in the shadowed block beside a full one. Noise that spreads evenly over the
// space would give the shadowed block a smaller relative error, because the full block has more values; with
// this weight both come out alike (measured: 0.8 and 0.9 cost 1 % and 0.5 % more bytes).
inline constexpr double kShadowedRoot = 0.85;

// Computes principal components: of a whole cell about zero, which gives the few coordinates in which
// clusters are made, and of one cluster about its mean. Sums are made range by range in order, and the sign
// of each eigenvector is fixed, so results are the same for any number of threads.

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

// How much an error in each sample counts (sampleImportance).
using Importance = std::span<const float>;

struct Cluster {
  double count = 0.0;
  double importance = 1.0;  // mean of its samples
  Eigen::VectorXf mean;
  Eigen::MatrixXf axes;        // all that the cluster's samples span, by falling variance
  Eigen::VectorXd variances;   // variances of the weights along each axis
  Eigen::VectorXd innovation;  // mean squared difference between a weight and its predecessor's
  Eigen::Index kept = 0;       // axes that are worth their bits at the step given to keepAxes
  double least_bits = 0.1;     // least number of bits that a weight counts for
};

using ClusterIds = std::vector<std::uint32_t>;

// Chooses means by k-means++ (Arthur and Vassilvitskii 2007) with hashed instead of random numbers. Returns
// fewer than `clusters` if there are fewer distinct points.
ClusterIds seedClusters(const Points& points, std::uint32_t clusters, Importance importance);

// Drops clusters without samples and renumbers the ids. With `held_out`, variances are estimated as for
// samples that were not fitted, which suits estimates from few samples.
std::vector<Cluster> fitClusters(const Points& points, ClusterIds& ids, bool held_out, Importance importance,
                                 double least_bits = 0.1);

// Returns the step of a cluster's weights: errors of samples that count more are smaller.
double stepOf(const Cluster& cluster, double step);

// Returns how finely the coordinates of a unit axis must be known if its `count` weights have this variance.
// One bit less on any number, coordinate or weight, should add the same error; so errors of the axis times
// its weights add rank/count of the quantization error of the weights, clamped to 0.2..1.5.
double axisGrid(Eigen::Index rank, double variance, double step, double count);

// Decides which axes are worth their bits.
void keepAxes(std::vector<Cluster>& clusters, double step);

// Returns the largest step for which the expected mean square error stays under `budget`, and keeps axes for
// it.
double stepFor(std::vector<Cluster>& clusters, double budget);

// Cuts a cluster in the middle of the range that its weights along an axis span. The samples of the upper
// half move to a cluster whose id is the next one free. The cluster must have been fitted to its samples.
void splitAlong(const Points& points, ClusterIds& ids, const std::vector<Cluster>& clusters,
                std::uint32_t cluster, Eigen::Index axis);

// Moves every sample to the cluster where it costs least. `before` holds the current ids, or is empty.
ClusterIds assignClusters(const Points& points, const std::vector<Cluster>& clusters, double step,
                          std::span<const std::uint32_t> before, Importance importance);

// Returns the expected size of codebook, ids and weights if the clusters held `count` samples in all.
double expectedBytes(const std::vector<Cluster>& clusters, double step, double count);

}  // namespace lambent::baker
