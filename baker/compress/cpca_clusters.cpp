#include "baker/compress/cpca_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
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

// Hashes a counter (splitmix64; Steele, Lea and Flood 2014).
std::uint64_t splitMix(std::uint64_t counter) {
  std::uint64_t z = (counter + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ z >> 27) * 0x94d049bb133111ebull;
  return z ^ z >> 31;
}

// Returns a number with mean 0 and variance 1 from a counter. Two-valued numbers sketch as well as normal
// ones.
float sign(std::uint64_t counter) {
  return splitMix(counter) & 1 ? 1.0f : -1.0f;
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

namespace {

constexpr std::size_t kPointsPerRange = 1024;
constexpr std::size_t kClusterBlock = 256;  // samples gathered for one matrix product
constexpr double kFewestMembers = 8.0;      // below this a cluster is not worth its mean and id
constexpr double kNamingPrice = 2.0;        // a change of cluster also breaks the prediction of weights
constexpr double kLeastAxisShare = 0.2, kMostAxisShare = 1.5;
constexpr std::size_t kNearest = 8;  // clusters tried per sample, by distance to their means

// Returns the entropy of a Gaussian weight of this variance in steps, plus a fixed cost.
double weightBits(double variance, double step, double least_bits) {
  const double in_steps = variance / (step * step) + 1.0 / 12.0;
  return std::max(least_bits, 0.5 * std::log2(2.0 * std::numbers::pi * std::numbers::e * in_steps)) + 0.05;
}

// Returns the bits in the codebook of a unit vector that is known well enough for weights of this variance
// (axisGrid): those of an integer of typical size for each coordinate.
double axisBits(Eigen::Index rank, double variance, double step, double count) {
  const auto coordinates = static_cast<double>(rank);
  const double typical = 1.0 / (std::sqrt(coordinates) * axisGrid(rank, variance, step, count));
  return 40.0 + coordinates * (0.5 + 1.1 * std::log2(1.0 + typical));
}

double bitPrice(double step) {
  return 2.0 * std::numbers::ln2 * step * step / 12.0;
}

// Returns a number in 0..1 from a counter.
double hashed(std::uint64_t counter) {
  return static_cast<double>(splitMix(counter) >> 11) * 0x1p-53;
}

double expectedError(const Cluster& cluster, double common_step) {
  const double step = stepOf(cluster, common_step);
  double error = 0.0;
  for (Eigen::Index j = 0; j < cluster.variances.size(); ++j)
    error += j < cluster.kept ? step * step / 12.0 : cluster.variances(j);
  return cluster.importance * error;
}

void keepAxesOf(Cluster& cluster, double common_step) {
  const double step = stepOf(cluster, common_step);
  cluster.kept = 0;
  const double noise = step * step / 12.0, price = bitPrice(step);
  for (Eigen::Index j = 0; j < cluster.variances.size(); ++j) {
    const double variance = cluster.variances(j);
    if (variance <= noise) break;
    const double bits =
        cluster.count * weightBits(std::min(variance, cluster.innovation(j)), step, cluster.least_bits) +
        axisBits(cluster.axes.rows(), variance, step, cluster.count);
    if (cluster.count * (variance - noise) <= price * bits) break;
    cluster.kept = j + 1;
  }
}

// Lists by cluster the samples of a block beginning at `begin` that may belong there: the cluster is near, or
// was their own before, or that of the previous sample. `distances` has one column per sample.
std::vector<std::vector<std::uint32_t>> candidates(const Eigen::MatrixXf& distances,
                                                   std::span<const std::uint32_t> before, std::size_t begin) {
  std::vector<std::vector<std::uint32_t>> samples(static_cast<std::size_t>(distances.rows()));
  std::vector<std::uint32_t> order(samples.size());
  for (std::uint32_t s = 0; s < distances.cols(); ++s) {
    const auto own = distances.col(s);
    std::iota(order.begin(), order.end(), 0u);
    const auto last = order.begin() + static_cast<std::ptrdiff_t>(std::min(kNearest, order.size()));
    std::partial_sort(order.begin(), last, order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return own(a) != own(b) ? own(a) < own(b) : a < b;
    });
    const auto add = [&](std::uint32_t c) {
      if (samples[c].empty() || samples[c].back() != s) samples[c].push_back(s);
    };
    std::for_each(order.begin(), last, add);
    if (before.empty()) continue;
    add(before[begin + s]);
    if (begin + s > 0) add(before[begin + s - 1]);
  }
  return samples;
}

}  // namespace

double stepOf(const Cluster& cluster, double step) {
  return step / std::sqrt(cluster.importance);
}

double axisGrid(Eigen::Index rank, double variance, double step, double count) {
  const double share = std::clamp(static_cast<double>(rank) / count, kLeastAxisShare, kMostAxisShare);
  return step * std::sqrt(share / (static_cast<double>(rank) * variance));
}

ClusterIds seedClusters(const Points& points, std::uint32_t clusters, Importance importance) {
  const auto count = static_cast<std::size_t>(points.cols());
  ClusterIds ids(count, 0);
  std::vector<double> distance(count, std::numeric_limits<double>::infinity());
  Eigen::Index seed = 0;
  for (std::uint32_t c = 0; c < clusters; ++c) {
    parallelRanges(count, kPointsPerRange, {}, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const double d = double{(points.col(static_cast<Eigen::Index>(s)) - points.col(seed)).squaredNorm()} *
                         double{importance[s]};
        if (d >= distance[s]) continue;
        distance[s] = d;
        ids[s] = c;
      }
    });
    const double total = std::accumulate(distance.begin(), distance.end(), 0.0);
    if (!(total > 0.0)) break;  // every point is a seed or equal to one
    double left = hashed(c) * total;
    std::size_t next = 0;
    for (std::size_t s = 0; s < count; ++s) {
      if (distance[s] <= 0.0) continue;
      next = s;
      if ((left -= distance[s]) <= 0.0) break;
    }
    seed = static_cast<Eigen::Index>(next);
  }
  return ids;
}

std::vector<Cluster> fitClusters(const Points& points, ClusterIds& ids, bool held_out, Importance importance,
                                 double least_bits) {
  const std::uint32_t numbered = ids.empty() ? 0 : *std::max_element(ids.begin(), ids.end()) + 1;
  std::vector<std::vector<std::uint32_t>> members(numbered);
  for (std::uint32_t s = 0; s < ids.size(); ++s) members[ids[s]].push_back(s);
  std::vector<std::uint32_t> renumbered(numbered, 0);
  std::uint32_t used = 0;
  for (std::uint32_t c = 0; c < numbered; ++c) {
    if (members[c].empty()) continue;
    renumbered[c] = used;
    if (used != c) members[used] = std::move(members[c]);
    ++used;
  }
  for (std::uint32_t& id : ids) id = renumbered[id];

  std::vector<Cluster> clusters(used);
  parallelRanges(used, 1, {}, [&](std::size_t c, std::size_t) {
    Cluster& cluster = clusters[c];
    const std::vector<std::uint32_t>& own = members[c];
    cluster.count = static_cast<double>(own.size());
    cluster.least_bits = least_bits;
    double counts = 0.0;
    for (const std::uint32_t s : own) counts += double{importance[s]};
    cluster.importance = counts / cluster.count;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(points.rows());
    for (const std::uint32_t s : own) sum += points.col(s).cast<double>();
    cluster.mean = (sum / cluster.count).cast<float>();
    const Spectrum spectrum = spectrumAbout(points, own, cluster.mean);
    cluster.axes = spectrum.axes.cast<float>();
    cluster.variances = spectrum.variances;
    // Sums squared differences between neighbours of the cluster along the axes.
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(cluster.axes.cols());
    Points block(points.rows(), static_cast<Eigen::Index>(kClusterBlock));
    for (std::size_t first = 1; first < own.size(); first += kClusterBlock) {
      const std::size_t last = std::min(own.size(), first + kClusterBlock);
      for (std::size_t m = first; m < last; ++m)
        block.col(static_cast<Eigen::Index>(m - first)) = points.col(own[m]) - points.col(own[m - 1]);
      const Points along = cluster.axes.transpose() * block.leftCols(static_cast<Eigen::Index>(last - first));
      squares += along.rowwise().squaredNorm().cast<double>();
    }
    cluster.innovation = squares / std::max(1.0, cluster.count - 1.0);
    // n samples leave n - 1 - j dimensions of noise to axis j, so its variance looks smaller than it is.
    if (held_out)
      for (Eigen::Index j = 0; j < cluster.variances.size(); ++j)
        cluster.variances(j) *= cluster.count / std::max(1.0, cluster.count - 1.0 - static_cast<double>(j));
  });
  return clusters;
}

void keepAxes(std::vector<Cluster>& clusters, double step) {
  parallelRanges(clusters.size(), 1, {}, [&](std::size_t c, std::size_t) { keepAxesOf(clusters[c], step); });
}

double stepFor(std::vector<Cluster>& clusters, double budget) {
  double total = 0.0, largest = 0.0, most = 1.0;
  for (const Cluster& cluster : clusters) {
    total += cluster.count;
    most = std::max(most, cluster.importance);
    if (cluster.variances.size() > 0) largest = std::max(largest, cluster.variances.maxCoeff());
  }
  const auto error = [&](double step) {
    keepAxes(clusters, step);
    double sum = 0.0;
    for (const Cluster& cluster : clusters) sum += cluster.count * expectedError(cluster, step);
    return sum / total;
  };
  double high = std::sqrt(12.0 * std::max(largest, budget) * most), low = 1e-6 * high;
  if (error(high) <= budget) return high;
  for (int i = 0; i < 24; ++i) {
    const double middle = std::sqrt(low * high);
    (error(middle) <= budget ? low : high) = middle;
  }
  keepAxes(clusters, low);
  return low;
}

void splitAlong(const Points& points, ClusterIds& ids, const std::vector<Cluster>& clusters,
                std::uint32_t cluster, Eigen::Index axis) {
  const Eigen::VectorXf along = clusters[cluster].axes.col(axis);
  const auto weight = [&](std::size_t s) { return along.dot(points.col(static_cast<Eigen::Index>(s))); };
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (std::size_t s = 0; s < ids.size(); ++s) {
    if (ids[s] != cluster) continue;
    low = std::min(low, weight(s));
    high = std::max(high, weight(s));
  }
  const std::uint32_t free = *std::max_element(ids.begin(), ids.end()) + 1;
  const float middle = low + 0.5f * (high - low);
  for (std::size_t s = 0; s < ids.size(); ++s)
    if (ids[s] == cluster && weight(s) > middle) ids[s] = free;
}

ClusterIds assignClusters(const Points& points, const std::vector<Cluster>& clusters, double step,
                          std::span<const std::uint32_t> before, Importance importance) {
  struct Prepared {
    Eigen::VectorXf spread;  // price of a weight's distance from 0
    float noise = 0.0f;      // square error of the weights
    float cost = 0.0f;       // price of the bits
  };
  const double price = bitPrice(step);
  double largest = 0.0;
  for (const Cluster& cluster : clusters) largest = std::max(largest, cluster.count);
  std::vector<Prepared> prepared(clusters.size());
  Eigen::MatrixXf means(points.rows(), static_cast<Eigen::Index>(clusters.size()));
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const Cluster& cluster = clusters[c];
    means.col(static_cast<Eigen::Index>(c)) = cluster.mean;
    prepared[c].spread.resize(cluster.kept);
    const double own_step = stepOf(cluster, step);
    double cost = 0.0, noise = 0.0;
    for (Eigen::Index j = 0; j < cluster.kept; ++j) {
      const double variance = cluster.variances(j);
      noise += own_step * own_step / 12.0;
      cost += price * (weightBits(std::min(variance, cluster.innovation(j)), own_step, cluster.least_bits) -
                       0.5 / std::numbers::ln2);
      prepared[c].spread(j) =
          static_cast<float>(price * 0.5 / std::numbers::ln2 / (variance + own_step * own_step / 12.0));
    }
    prepared[c].noise = static_cast<float>(noise);
    // Small clusters lose their members to others, unless all clusters are small.
    const bool open = cluster.count >= std::min(largest, kFewestMembers);
    prepared[c].cost = open ? static_cast<float>(cost) : std::numeric_limits<float>::max();
  }
  const auto name =
      static_cast<float>(kNamingPrice * price * std::log2(static_cast<double>(clusters.size()) + 1.0));

  const Eigen::VectorXf norms = means.colwise().squaredNorm();
  ClusterIds ids(static_cast<std::size_t>(points.cols()));
  parallelRanges(ids.size(), kPointsPerRange, {}, [&](std::size_t begin, std::size_t end) {
    const auto block =
        points.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin));
    const auto tried = candidates((-2.0f * means.transpose() * block).colwise() + norms, before, begin);
    std::vector<float> best(end - begin, std::numeric_limits<float>::infinity());
    Eigen::MatrixXf off, weights;
    for (std::uint32_t c = 0; c < clusters.size(); ++c) {
      const std::vector<std::uint32_t>& samples = tried[c];
      const auto count = static_cast<Eigen::Index>(samples.size());
      if (count == 0) continue;
      off.resize(points.rows(), count);
      for (Eigen::Index m = 0; m < count; ++m)
        off.col(m) = block.col(samples[static_cast<std::size_t>(m)]) - clusters[c].mean;
      weights.noalias() = clusters[c].axes.leftCols(clusters[c].kept).transpose() * off;
      for (Eigen::Index m = 0; m < count; ++m) {
        const std::uint32_t in_block = samples[static_cast<std::size_t>(m)];
        const std::size_t s = begin + in_block;
        float cost =
            importance[s] * (off.col(m).squaredNorm() - weights.col(m).squaredNorm() + prepared[c].noise) +
            prepared[c].cost + weights.col(m).cwiseAbs2().dot(prepared[c].spread);
        // The id of a cluster costs almost nothing if a neighbour has the same one.
        if (!before.empty() &&
            !((s > 0 && before[s - 1] == c) || (s + 1 < before.size() && before[s + 1] == c)))
          cost += name;
        if (cost >= best[in_block]) continue;
        best[in_block] = cost;
        ids[s] = c;
      }
    }
  });
  return ids;
}

double expectedBytes(const std::vector<Cluster>& clusters, double common_step, double count) {
  double total = 0.0, bits = 0.0;
  for (const Cluster& cluster : clusters) total += cluster.count;
  for (const Cluster& cluster : clusters) {
    const double share = cluster.count / total * count, step = stepOf(cluster, common_step);
    for (Eigen::Index j = 0; j < cluster.kept; ++j)
      bits += share * weightBits(std::min(cluster.variances(j), cluster.innovation(j)), step,
                                 cluster.least_bits) +
              axisBits(cluster.axes.rows(), cluster.variances(j), step, share);
    bits += 8.0 * static_cast<double>(cluster.mean.size());
  }
  bits += count * 0.4 * std::log2(static_cast<double>(clusters.size()));
  return bits / 8.0;
}

}  // namespace lambent::baker
