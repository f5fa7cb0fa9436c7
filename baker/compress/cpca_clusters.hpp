// Clusters of samples that lie near common affine subspaces (Sloan 2003, section 4.2: iterative PCA). A
// sample belongs where it costs least, in error and bits together: an axis costs bits for each sample and
// bits in the codebook, a cluster costs bits to be named. Error and bits are made one by the step of the
// weights' quantization: with uniform steps, one bit more on a weight lowers its square error step²/12 to a
// quarter, so at the margin a bit is worth 2 ln 2 step²/12.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/compress/cpca_spectrum.hpp"

namespace lambent::baker {

struct Cluster {
  double count = 0.0;
  Eigen::VectorXf mean;
  Eigen::MatrixXf axes;        // all that samples of the cluster span, by falling variance
  Eigen::VectorXd variances;   // of the weights of each axis
  Eigen::VectorXd innovation;  // mean square of what a weight's predecessor does not foretell
  Eigen::Index kept = 0;       // axes worth their bits at the step that keepAxes was given
  double least_bits = 0.1;     // that a weight counts for, however little it says
};

using ClusterIds = std::vector<std::uint32_t>;

// Means by k-means++ (Arthur and Vassilvitskii 2007) with hashed instead of random numbers. Fewer than
// `clusters` where there are not so many different points.
ClusterIds seedClusters(const Points& points, std::uint32_t clusters);

// Clusters without samples are left out and ids closed up. `held_out`: variances as they would be on samples
// that were not fitted, for estimates from few samples.
std::vector<Cluster> fitClusters(const Points& points, ClusterIds& ids, bool held_out,
                                 double least_bits = 0.1);

// How finely coordinates of a unit axis have to be known whose `count` weights have this variance. A bit less
// on each number, coordinate or weight, should add the same error: so errors of the axis, times its weights,
// add rank/count of what quantization of the weights leaves, within 0.2 and 1.5.
double axisGrid(Eigen::Index rank, double variance, double step, double count);

// Decides which axes are worth their bits.
void keepAxes(std::vector<Cluster>& clusters, double step);

// The first `axes` of each, as far as they have any variance.
void keepSoMany(std::vector<Cluster>& clusters, int axes);

// The largest step for which the expected mean square error stays under `budget`; keeps axes for it.
double stepFor(std::vector<Cluster>& clusters, double budget);

// Moves every sample to the cluster where it costs least. `before`: the ids so far, or nothing.
ClusterIds assignClusters(const Points& points, const std::vector<Cluster>& clusters, double step,
                          std::span<const std::uint32_t> before);

// Expected size of codebook, ids and weights if the clusters held `count` samples in all.
double expectedBytes(const std::vector<Cluster>& clusters, double step, double count);

}  // namespace lambent::baker
