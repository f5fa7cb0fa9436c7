#include "baker/compress/cpca.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "baker/compress/cpca_clusters.hpp"
#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

// Clusters become integers. The basis and the clusters' means and axes are rounded to grids as coarse as the
// error allows; then the weights of every sample are fitted by least squares to the rounded axes, all with
// the same step.

constexpr double kLargestCoordinate = transfer::kMaxCoordinate - 1;
constexpr double kMaxCode = 65535.0;

std::int32_t rounded(double value) {
  return static_cast<std::int32_t>(std::lround(std::clamp(value, -kLargestCoordinate, kLargestCoordinate)));
}

// Rounds to quarter octaves, since few different values code to few bytes.
double coarse(double value) {
  return std::exp2(std::round(4.0 * std::log2(value)) / 4.0);
}

// An axis of a cluster whose weights span more steps than a code of 16 bits has values. The weights were
// coded with longer steps there, so the bound may be missed however small the step is.
struct WideAxis {
  std::uint32_t cluster = 0;  // index into the clusters given
  Eigen::Index axis = 0;
};

struct Quantized {
  CodedTransfer transfer;      // all but `error`
  std::vector<WideAxis> wide;  // at most one of each cluster, its widest
};

struct CodedCluster {
  std::vector<std::int32_t> mean, directions;  // [coordinate], [axis][coordinate]
  std::vector<transfer::AxisCode> axes;
  std::vector<std::vector<std::uint32_t>> codes;  // [axis][member]
  std::optional<Eigen::Index> wide;               // WideAxis::axis
};

CodedCluster codeCluster(const Points& points, std::span<const std::uint32_t> members, const Cluster& cluster,
                         double mean_grid, double common_step) {
  const double step = stepOf(cluster, common_step);
  const Eigen::Index rank = points.rows();
  CodedCluster coded;
  Eigen::VectorXd mean(rank);
  for (Eigen::Index r = 0; r < rank; ++r) {
    coded.mean.push_back(rounded(double{cluster.mean(r)} / mean_grid));
    mean(r) = mean_grid * coded.mean.back();
  }
  // The errors of these grids, times the weights, suit the quantization of the weights.
  Eigen::MatrixXd axes(rank, cluster.kept);
  Eigen::VectorXd scales(cluster.kept);
  for (Eigen::Index j = 0; j < cluster.kept; ++j) {
    const double grid =
        coarse(std::max(axisGrid(rank, cluster.variances(j), step, cluster.count), 2.0 / kLargestCoordinate));
    scales(j) = step * grid;
    for (Eigen::Index r = 0; r < rank; ++r) {
      coded.directions.push_back(rounded(double{cluster.axes(r, j)} / grid));
      axes(r, j) = coded.directions.back();
    }
  }
  Eigen::MatrixXd weights(cluster.kept, static_cast<Eigen::Index>(members.size()));
  if (cluster.kept > 0) {
    const Eigen::LDLT<Eigen::MatrixXd> gram(axes.transpose() * axes);
    const Eigen::MatrixXd solve = gram.solve(axes.transpose());
    for (std::size_t m = 0; m < members.size(); ++m)
      weights.col(static_cast<Eigen::Index>(m)).noalias() =
          solve * (points.col(members[m]).cast<double>() - mean);
  }
  double widest = 1.0;
  for (Eigen::Index j = 0; j < cluster.kept; ++j) {
    const double low = weights.row(j).minCoeff(), high = weights.row(j).maxCoeff();
    if (const double spans = (high - low) / (kMaxCode * scales(j)); spans > widest) {
      widest = spans;
      coded.wide = j;
    }
    const auto scale = static_cast<float>(std::max(scales(j), (high - low) / kMaxCode));
    const double first = std::floor(low / double{scale} + 0.5);
    const auto offset = static_cast<float>(first * double{scale});
    std::vector<std::uint32_t> codes;
    for (std::size_t m = 0; m < members.size(); ++m)
      codes.push_back(static_cast<std::uint32_t>(
          std::clamp(std::round((weights(j, static_cast<Eigen::Index>(m)) - double{offset}) / double{scale}),
                     0.0, kMaxCode)));
    coded.axes.push_back({offset, scale});
    coded.codes.push_back(std::move(codes));
  }
  return coded;
}

// Rounds the basis of the cell and returns the codebook's basis, basis_scales and value_scales. `axes` are
// columns in the weighted space, `energies` their mean square coordinates, and `roots` those of
// WeightedSpace.
transfer::SharedCodebook roundedBasis(const Eigen::MatrixXd& axes, const Eigen::VectorXd& energies,
                                      const std::vector<double>& roots, double step) {
  transfer::SharedCodebook basis;
  for (const double root : roots)
    basis.value_scales.push_back(root > 0.0 ? static_cast<float>(1.0 / root) : 0.0f);
  for (Eigen::Index r = 0; r < axes.cols(); ++r) {
    // Errors of the basis add, for each vector, a tenth of the quantization error of one axis' weights. The
    // grid is kept fine enough that even an unimportant axis keeps its direction.
    const double coarsest = axes.col(r).cwiseAbs().maxCoeff() / 4.0;
    const double grid =
        std::clamp(step * std::sqrt(0.1 / (static_cast<double>(axes.rows()) * std::max(energies(r), 1e-300))),
                   1.0 / kLargestCoordinate, std::max(coarsest, 1.0 / kLargestCoordinate));
    basis.basis_scales.push_back(static_cast<float>(grid));
    for (Eigen::Index i = 0; i < axes.rows(); ++i) basis.basis.push_back(rounded(axes(i, r) / grid));
  }
  return basis;
}

// `points` are coordinates over the rounded basis.
Quantized quantize(const Points& points, const ClusterIds& ids, const std::vector<Cluster>& clusters,
                   const transfer::SharedCodebook& basis, const transfer::TransferShape& shape, double step) {
  // Clusters are ordered by falling number of axes.
  std::vector<std::uint32_t> order(clusters.size()), place(clusters.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return clusters[a].kept > clusters[b].kept; });
  for (std::uint32_t c = 0; c < order.size(); ++c) place[order[c]] = c;
  Quantized quantized;
  CodedTransfer& coded = quantized.transfer;
  coded.shape = shape;
  coded.codebook = basis;
  std::vector<std::vector<std::uint32_t>> members(clusters.size());
  for (std::uint32_t s = 0; s < ids.size(); ++s) {
    coded.cluster_of.push_back(place[ids[s]]);
    members[place[ids[s]]].push_back(s);
  }
  double mean_axes = 1.0, most = 1e-300;
  for (const Cluster& cluster : clusters) most = std::max(most, cluster.importance);
  for (const Cluster& cluster : clusters)
    mean_axes += cluster.count / static_cast<double>(ids.size()) * static_cast<double>(cluster.kept);
  const auto rank = static_cast<std::size_t>(points.rows());
  // Errors of the means add a fiftieth, since no weight corrects them along axes that are left out.
  double mean_grid =
      step * std::sqrt(0.02 * mean_axes / (most * static_cast<double>(std::max<std::size_t>(rank, 1))));
  for (const Cluster& cluster : clusters)
    mean_grid = std::max(mean_grid, double{cluster.mean.cwiseAbs().maxCoeff()} / kLargestCoordinate);
  mean_grid = double{static_cast<float>(mean_grid)};

  std::vector<CodedCluster> parts(clusters.size());
  parallelRanges(parts.size(), 1, {}, [&](std::size_t c, std::size_t) {
    parts[c] = codeCluster(points, members[c], clusters[order[c]], mean_grid, step);
  });
  for (std::size_t c = 0; c < parts.size(); ++c)
    if (parts[c].wide) quantized.wide.push_back({order[c], *parts[c].wide});
  transfer::SharedCodebook& book = coded.codebook;
  book.mean_scale = static_cast<float>(mean_grid);
  for (const CodedCluster& part : parts) {
    book.axis_counts.push_back(static_cast<std::uint32_t>(part.axes.size()));
    book.axes.insert(book.axes.end(), part.axes.begin(), part.axes.end());
  }
  for (std::size_t r = 0; r < rank; ++r)
    for (const CodedCluster& part : parts) book.means.push_back(part.mean[r]);
  for (std::size_t j = 0; j < parts.front().axes.size(); ++j)  // the first cluster has the most axes
    for (std::size_t r = 0; r < rank; ++r)
      for (const CodedCluster& part : parts)
        if (j < part.axes.size()) book.directions.push_back(part.directions[j * rank + r]);

  double variance = 1e-300;
  for (const Cluster& cluster : clusters) variance += cluster.count * cluster.variances.sum();
  coded.planes.resize(book.axis_counts.empty() ? 0 : book.axis_counts.front());
  for (std::size_t j = 0; j < coded.planes.size(); ++j) {
    CodedPlane& plane = coded.planes[j];
    double own = 0.0;
    for (std::size_t c = 0; c < parts.size() && j < parts[c].codes.size(); ++c) {
      plane.codes.insert(plane.codes.end(), parts[c].codes[j].begin(), parts[c].codes[j].end());
      own += clusters[order[c]].count * clusters[order[c]].variances(static_cast<Eigen::Index>(j));
    }
    plane.bits = *std::max_element(plane.codes.begin(), plane.codes.end()) < 256 ? 8 : 16;
    plane.variance = static_cast<float>(own / variance);
  }
  return quantized;
}

constexpr std::size_t kVectorsPerRange = 512;
constexpr std::size_t kBasisSamples = 8192;  // samples that the covariance uses at least
// Multiply-adds that the covariance may take. With few values per sample this covers all samples, which
// matters because some are rare: those of a grid beside the body are unlike all others, few samples next to a
// lamp hold nearly all of its energy, and a room has some that face where hardly any others do.
constexpr double kBasisWork = 1.6e10;
constexpr double kTailShare = 0.05;     // share of the allowed square error that the basis may leave out
constexpr double kBesideLeftOut = 1.3;  // allowed square error relative to what the basis has to leave out
// Length of the runs of neighbours that are kept if only some samples are used.
constexpr std::size_t kRun = 64;
constexpr std::size_t kLeastSearched = 4096, kSearchedPerCluster = 96;
constexpr int kSearchRounds = 4, kFinalRounds = 3, kMostAttempts = 8;
constexpr int kMostCuts = 8;  // each halves a range of weights, and floats hold 256 times what codes do
// Bits that a weight counts for at least in the choice of axes. A weight of a glossy sample costs 25
// multiply-adds of four numbers whenever light changes, so axes that are nearly all noise are not worth their
// time.
constexpr double kPlainWeightBits = 0.1, kGlossyWeightBits = 1.5;
constexpr std::uint32_t kClusterCounts[] = {1, 4, 16, 64, 128, 256};

// Returns all samples, or about `kept` of them in runs of neighbours spread over the cell. One of each
// `stride` runs is taken, at a place that varies by the golden ratio; a fixed place could be in step with the
// rows of a grid of points and miss whole layers of it.
std::vector<std::uint32_t> someSamples(std::size_t count, std::size_t kept) {
  std::vector<std::uint32_t> samples;
  const std::size_t runs = (count + kRun - 1) / kRun, stride = std::max<std::size_t>(1, count / kept);
  for (std::size_t first = 0; first < runs; first += stride) {
    const std::uint32_t golden = static_cast<std::uint32_t>(first / stride) * 2654435769u;
    const std::size_t run =
        std::min(first + static_cast<std::size_t>(std::uint64_t{golden} * stride >> 32), runs - 1);
    for (std::size_t s = run * kRun; s < std::min(count, (run + 1) * kRun); ++s)
      samples.push_back(static_cast<std::uint32_t>(s));
  }
  return samples;
}

Points weighted(std::span<const float> vectors, const std::vector<double>& roots,
                std::span<const std::uint32_t> samples) {
  const std::size_t size = roots.size();
  Points out(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(samples.size()));
  for (std::size_t s = 0; s < samples.size(); ++s)
    for (std::size_t i = 0; i < size; ++i)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(s)) =
          static_cast<float>(roots[i] * double{vectors[samples[s] * size + i]});
  return out;
}

// Returns the coordinates of all samples over the rounded basis, by least squares.
Points coordinates(std::span<const float> vectors, const std::vector<double>& roots,
                   const transfer::SharedCodebook& basis) {
  const auto size = static_cast<Eigen::Index>(roots.size()),
             rank = static_cast<Eigen::Index>(basis.basis_scales.size());
  Eigen::MatrixXd axes(size, rank);
  for (Eigen::Index r = 0; r < rank; ++r)
    for (Eigen::Index i = 0; i < size; ++i)
      axes(i, r) = double{basis.basis_scales[static_cast<std::size_t>(r)]} *
                   basis.basis[static_cast<std::size_t>(r * size + i)];
  const Eigen::LDLT<Eigen::MatrixXd> gram(axes.transpose() * axes);
  Eigen::MatrixXd solve = gram.solve(axes.transpose());
  for (Eigen::Index i = 0; i < size; ++i) solve.col(i) *= roots[static_cast<std::size_t>(i)];
  const Eigen::MatrixXf project = solve.cast<float>();
  const std::size_t count = vectors.size() / roots.size();
  Points points(rank, static_cast<Eigen::Index>(count));
  parallelRanges(count, kVectorsPerRange, {}, [&](std::size_t begin, std::size_t end) {
    const Eigen::Map<const Eigen::MatrixXf> block(vectors.data() + begin * roots.size(), size,
                                                  static_cast<Eigen::Index>(end - begin));
    points.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin)).noalias() =
        project * block;
  });
  return points;
}

struct Clustering {
  ClusterIds ids;
  std::vector<Cluster> clusters;
  double step = 0.0;
};

// Returns the size of the decoded means and axes.
std::size_t expandedBytes(const std::vector<Cluster>& clusters, const transfer::TransferShape& shape) {
  std::size_t vectors = clusters.size();
  for (const Cluster& cluster : clusters) vectors += static_cast<std::size_t>(cluster.kept);
  return vectors * shape.size() * sizeof(float);
}

class Coder {
 public:
  Coder(std::span<const float> vectors, const transfer::TransferShape& shape, const CodingSettings& settings,
        std::stop_token stop)
      : vectors_(vectors),
        shape_(shape),
        settings_(settings),
        stop_(std::move(stop)),
        count_(vectors.size() / shape.size()),
        space_(weightedSpace(vectors, shape, settings.shown_energy, settings.kernel_power)),
        importance_(
            sampleImportance(vectors, shape, settings.shown_energy, settings.kernel_power, settings.weights)),
        least_bits_(shape.beyondDiffuse() ? kGlossyWeightBits : kPlainWeightBits) {
    const double bound = double{settings.bound};
    allowed_ = bound * bound * space_.blocks / static_cast<double>(count_);
  }

  CodedTransfer code() {
    findBasis();
    if (basis_.basis_scales.empty()) return dark();
    if (stopped()) return {};
    points_ = coordinates(vectors_, space_.roots, basis_);
    for (;;) {
      auto few = settings_.clusters > 0 ? fromSome(settings_.clusters) : search();
      if (!few) return {};
      ClusterIds ids = assignClusters(points_, few->clusters, few->step, {}, importance_);
      auto found = refine(points_, std::move(ids), kFinalRounds, /*held_out=*/false, importance_);
      if (!found) return {};
      const bool fewer = settings_.clusters == 0 && found->clusters.size() > 1;
      if (!fewer || fits(*found)) {
        const auto fitted = fitToBound(*found);
        if (!fitted) return {};
        if (*fitted || !fewer) return std::move(coded_);
      }
      // The estimate from some of the samples, or for the bound, was too small: try with half as many
      // clusters.
      most_clusters_ = static_cast<std::uint32_t>(found->clusters.size() / 2);
    }
  }

 private:
  bool stopped() const { return stop_.stop_requested(); }
  bool fits(const Clustering& one) const {
    return expandedBytes(one.clusters, shape_) <= settings_.most_expanded_bytes;
  }
  double errorOf(const CodedTransfer& coded) const {
    return radianceError(vectors_, decodeTransfer(coded), shape_, settings_.shown_energy,
                         settings_.kernel_power, settings_.weights);
  }

  void findBasis();
  CodedTransfer dark() const;
  // Runs rounds of iterative PCA, which fits and moves samples in turn. Returns nothing if stopped.
  std::optional<Clustering> refine(const Points& points, ClusterIds ids, int rounds, bool held_out,
                                   Importance importance) const;
  std::optional<Clustering> fromSome(std::uint32_t clusters) const;
  std::optional<Clustering> search() const;
  // Quantizes with this step.
  CodedTransfer coded(const Clustering& found, double step) const;
  // Leaves the best codes in coded_. Returns false if the memory for means and axes ran out before the
  // bound was reached, and nothing if stopped.
  std::optional<bool> fitToBound(Clustering& found);

  std::span<const float> vectors_;
  const transfer::TransferShape& shape_;
  const CodingSettings& settings_;
  std::stop_token stop_;
  std::size_t count_;
  WeightedSpace space_;
  std::vector<float> importance_;
  double least_bits_, allowed_ = 0.0;
  Points points_;
  transfer::SharedCodebook basis_;
  double reachable_ = 0.0, budget_ = 0.0;  // mean square errors
  std::uint32_t most_clusters_ = std::numeric_limits<std::uint32_t>::max();
  CodedTransfer coded_;  // the best so far
};

// Finds a basis for the cell: all principal components but those that hardly matter.
void Coder::findBasis() {
  double left_out = 0.0;
  const double size = static_cast<double>(shape_.size());
  const auto looked_at = std::max(kBasisSamples, static_cast<std::size_t>(kBasisWork / (size * size)));
  const auto looked = someSamples(count_, looked_at);
  Points some = weighted(vectors_, space_.roots, looked);
  for (std::size_t s = 0; s < looked.size(); ++s)
    some.col(static_cast<Eigen::Index>(s)) *= std::sqrt(importance_[looked[s]]);
  Spectrum spectrum = leadingSpectrum(some, kTailShare * allowed_, settings_.most_components, left_out);
  // If the components that were looked for leave out more than is allowed, the rest is coded to match.
  reachable_ = std::max(allowed_, kBesideLeftOut * left_out);
  const double looseness = double{settings_.loose_bound} / double{settings_.bound};
  double tail_allowed = kTailShare * allowed_;
  if (const double loose = looseness * looseness * allowed_; loose > allowed_ && reachable_ > loose) {
    tail_allowed = kTailShare * loose;
    spectrum = leadingSpectrum(some, tail_allowed, kAllComponents, left_out);
    reachable_ = std::max(loose, kBesideLeftOut * left_out);
  }
  budget_ = 0.9 * (reachable_ - left_out);  // the rest is for rounding of basis, means and axes
  Eigen::Index rank = spectrum.variances.size();
  for (double tail = left_out; rank > 0 && (tail += spectrum.variances(rank - 1)) <= left_out + tail_allowed;)
    --rank;
  const double step = std::sqrt(12.0 * budget_ / static_cast<double>(std::max<Eigen::Index>(rank, 1)));
  basis_ = roundedBasis(spectrum.axes.leftCols(rank), spectrum.variances, space_.roots, step);
}

CodedTransfer Coder::dark() const {
  CodedTransfer coded{shape_, basis_, std::vector<std::uint32_t>(count_, 0), {}, 0.0f};
  coded.codebook.axis_counts = {0};
  coded.error = static_cast<float>(errorOf(coded));
  return coded;
}

std::optional<Clustering> Coder::refine(const Points& points, ClusterIds ids, int rounds, bool held_out,
                                        Importance importance) const {
  for (int round = 0;; ++round) {
    Clustering found{std::move(ids), {}, 0.0};
    found.clusters = fitClusters(points, found.ids, held_out, importance, least_bits_);
    found.step = stepFor(found.clusters, budget_);
    if (round >= rounds || found.clusters.size() == 1) return found;
    ids = assignClusters(points, found.clusters, found.step, found.ids, importance);
    if (stopped()) return std::nullopt;
  }
}

std::optional<Clustering> Coder::fromSome(std::uint32_t clusters) const {
  const auto some = someSamples(count_, std::max(kLeastSearched, kSearchedPerCluster * clusters));
  const Points searched = points_(Eigen::all, some);
  std::vector<float> counts;
  for (const std::uint32_t s : some) counts.push_back(importance_[s]);
  return refine(searched, seedClusters(searched, clusters, counts), kSearchRounds, some.size() < count_,
                counts);
}

// Finds the number of clusters that codes to the fewest bytes, by estimates from some of the samples.
std::optional<Clustering> Coder::search() const {
  Clustering best;
  double fewest_bytes = std::numeric_limits<double>::infinity();
  for (const std::uint32_t clusters : kClusterCounts) {
    if (clusters > most_clusters_) break;
    auto tried = fromSome(clusters);
    if (!tried) return std::nullopt;
    if (clusters > 1 && !fits(*tried)) break;
    const double bytes = expectedBytes(tried->clusters, tried->step, static_cast<double>(count_));
    if (bytes >= fewest_bytes) break;
    fewest_bytes = bytes;
    best = std::move(*tried);
  }
  return best;
}

// A sample next to a lamp may share a cluster with dark ones, of which it is a ten-thousandth in number and
// ten thousand times as bright. Codes of 16 bits do not span the weights of both, so such a cluster is cut in
// two, as often as it takes.
CodedTransfer Coder::coded(const Clustering& found, double step) const {
  const auto quantized = [&](const ClusterIds& ids, const std::vector<Cluster>& clusters) {
    return quantize(points_, ids, clusters, basis_, shape_, step);
  };
  Quantized all = quantized(found.ids, found.clusters);
  if (settings_.clusters > 0 || all.wide.empty()) return std::move(all.transfer);
  Clustering cut = found;
  for (int i = 0; i < kMostCuts && !all.wide.empty(); ++i) {
    for (const WideAxis& wide : all.wide) splitAlong(points_, cut.ids, cut.clusters, wide.cluster, wide.axis);
    cut.clusters = fitClusters(points_, cut.ids, /*held_out=*/false, importance_, least_bits_);
    keepAxes(cut.clusters, step);
    if (!fits(cut)) break;
    all = quantized(cut.ids, cut.clusters);
  }
  return std::move(all.transfer);
}

// Steps were planned from expected errors and bits. This measures the errors and makes the step as large as
// the bound allows.
std::optional<bool> Coder::fitToBound(Clustering& found) {
  const double bound = double{settings_.bound} * std::sqrt(reachable_ / allowed_);
  CodedTransfer& best = coded_ = {};
  double step = found.step;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    keepAxes(found.clusters, step);
    if (attempt > 0 && !fits(found)) return double{best.error} <= bound;
    CodedTransfer tried = coded(found, step);
    tried.error = static_cast<float>(errorOf(tried));
    const float error = tried.error;
    const bool met = double{error} <= bound, met_before = double{best.error} <= bound;
    // Among codes that keep the bound, the larger error is the smaller code.
    if (attempt == 0 || (met ? !met_before || error > best.error : error < best.error))
      best = std::move(tried);
    if (met && double{best.error} > 0.98 * bound) break;
    if (best.planes.empty() && met) break;  // nothing left to save
    // Part of the error does not depend on the step (rounded means and axes, the weaker of the two blocks).
    // The rest has to make up for it, so the step goes down by the square of the ratio, and by more where
    // that has not sufficed.
    const double ratio = 0.995 * bound / std::max(double{error}, 1e-12);
    const double power = met ? 1.0 : attempt < 2 ? 2.0 : std::exp2(attempt);
    step *= std::clamp(std::pow(ratio, power), 0.3, 1.5);
    if (stopped()) return std::nullopt;
  }
  return true;
}

}  // namespace

std::vector<float> decodeTransfer(const CodedTransfer& coded) {
  std::vector<std::vector<std::uint32_t>> codes;
  for (const CodedPlane& plane : coded.planes) codes.push_back(plane.codes);
  return transfer::decodeTransfer(
      coded.shape, transfer::expand(coded.codebook), coded.cluster_of, codes,
      [](std::size_t count, const auto& body) { parallelRanges(count, kVectorsPerRange, {}, body); });
}

CodedTransfer codeTransfer(std::span<const float> vectors, [[maybe_unused]] std::size_t count,
                           const transfer::TransferShape& shape, const CodingSettings& settings,
                           std::stop_token stop) {
  assert(count > 0 && vectors.size() == count * shape.size() && settings.bound > 0.0f);
  return Coder(vectors, shape, settings, std::move(stop)).code();
}

}  // namespace lambent::baker
