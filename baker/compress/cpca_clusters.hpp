// Finds clusters of samples that lie near common affine subspaces (Sloan 2003, section 4.2: iterative PCA). A
// sample belongs where it costs least, in error and bits together: an axis costs bits for each sample and in
// the codebook, and a cluster costs bits for its id. The quantization step of the weights makes error and
// bits comparable: one more bit on a weight lowers its square error of step²/12 to a quarter, so at the
// margin a bit is worth 2 ln 2 step²/12.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/compress/cpca_spectrum.hpp"

namespace lambent::baker {

// How much an error in each sample counts (sampleImportance in cpca_space.hpp).
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

// Keeps the first `axes` axes of each cluster, as far as they have any variance.
void keepSoMany(std::vector<Cluster>& clusters, int axes);

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
