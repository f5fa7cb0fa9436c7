#include "baker/compress/cpca.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "baker/compress/cpca_clusters.hpp"
#include "baker/compress/cpca_quantize.hpp"
#include "baker/compress/cpca_space.hpp"
#include "baker/compress/cpca_spectrum.hpp"
#include "baker/work/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kGrain = 512;
constexpr std::size_t kBasisSamples = 8192;  // at least, for the covariance of all values
// Multiply-adds that may go into it for visibility and bounced light: where few values allow it all samples
// are looked at, for in grids around bodies rare ones, beside the body, are like no others.
constexpr double kBasisWork = 1.6e10;
constexpr double kTailShare = 0.05;     // of the square error allowed, for what the basis leaves out
constexpr double kBesideLeftOut = 1.3;  // of what the basis must leave out: all square error then
constexpr std::size_t kRun = 64;        // neighbours kept together where only some samples are taken
constexpr std::size_t kLeastSearched = 4096, kSearchedPerCluster = 96;
constexpr int kSearchRounds = 4, kFinalRounds = 3, kMostAttempts = 8;
// What a weight counts for in the choice of axes, however little it says. A weight of a glossy sample stands
// for 25 multiply-adds of four numbers whenever light changes, so axes that are nearly all noise are not
// worth their time.
constexpr double kPlainWeightBits = 0.1, kGlossyWeightBits = 1.5;
constexpr std::uint32_t kClusterCounts[] = {1, 4, 16, 64, 128, 256};

// Runs of neighbours spread over the cell: `kept` samples or all. One of each `stride` runs, now this and now
// that one by the golden ratio: the rows of a grid of points would else be in step with them, and whole
// layers of it never seen.
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

// Coordinates of all samples over the rounded basis, by least squares.
Points coordinates(std::span<const float> vectors, const std::vector<double>& roots,
                   const bundle::SharedCodebook& basis) {
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
  parallelRanges(count, kGrain, {}, [&](std::size_t begin, std::size_t end) {
    const Eigen::Map<const Eigen::MatrixXf> block(vectors.data() + begin * roots.size(), size,
                                                  static_cast<Eigen::Index>(end - begin));
    points.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin)).noalias() =
        project * block;
  });
  return points;
}

Points columnsOf(const Points& points, std::span<const std::uint32_t> samples) {
  Points out(points.rows(), static_cast<Eigen::Index>(samples.size()));
  for (std::size_t s = 0; s < samples.size(); ++s)
    out.col(static_cast<Eigen::Index>(s)) = points.col(samples[s]);
  return out;
}

struct Clustering {
  ClusterIds ids;
  std::vector<Cluster> clusters;
  double step = 0.0;
};

// Iterative PCA: fits and moves samples in turn.
Clustering refine(const Points& points, ClusterIds ids, double budget, int axes, int rounds, bool held_out,
                  double least_bits) {
  Clustering found{std::move(ids), {}, 0.0};
  for (int round = 0;; ++round) {
    found.clusters = fitClusters(points, found.ids, held_out, least_bits);
    found.step = stepFor(found.clusters, budget);
    if (axes >= 0) keepSoMany(found.clusters, axes);
    if (round == rounds || found.clusters.size() == 1) return found;
    found.ids = assignClusters(points, found.clusters, found.step, found.ids);
  }
}

Clustering fromSome(const Points& points, std::uint32_t clusters, double budget, int axes,
                    double least_bits) {
  const auto count = static_cast<std::size_t>(points.cols());
  const auto some = someSamples(count, std::max(kLeastSearched, kSearchedPerCluster * clusters));
  const Points searched = columnsOf(points, some);
  return refine(searched, seedClusters(searched, clusters), budget, axes, kSearchRounds, some.size() < count,
                least_bits);
}

// Of means and axes, decoded.
std::size_t expandedBytes(const std::vector<Cluster>& clusters, const bundle::TransferShape& shape) {
  std::size_t vectors = clusters.size();
  for (const Cluster& cluster : clusters) vectors += static_cast<std::size_t>(cluster.kept);
  return vectors * shape.size() * sizeof(float);
}

// The number of clusters that codes to the fewest bytes, by estimates from some of the samples; at most so
// many.
Clustering search(const Points& points, double budget, double least_bits, const auto& fits,
                  std::uint32_t most, const std::stop_token& stop) {
  Clustering best;
  double fewest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t clusters : kClusterCounts) {
    if (stop.stop_requested() || clusters > most) break;
    Clustering tried = fromSome(points, clusters, budget, -1, least_bits);
    if (clusters > 1 && !fits(tried)) break;
    const double bytes = expectedBytes(tried.clusters, tried.step, static_cast<double>(points.cols()));
    if (bytes >= fewest) break;
    fewest = bytes;
    best = std::move(tried);
  }
  return best;
}

std::vector<float> decode(const CodedTransfer& coded) {
  std::vector<std::vector<std::uint32_t>> codes;
  for (const CodedPlane& plane : coded.planes) codes.push_back(plane.codes);
  return bundle::decodeTransfer(coded.shape, bundle::expand(coded.codebook), coded.cluster_of, codes);
}

// Steps are planned by what errors and bits are expected to be; here they are measured, and the step made as
// large as the bound allows.
CodedTransfer fitToBound(std::span<const float> vectors, const Points& points, Clustering& found,
                         const bundle::SharedCodebook& basis, const bundle::TransferShape& shape,
                         const CodingSettings& settings, double bound, const std::stop_token& stop) {
  CodedTransfer best;
  double step = found.step;
  for (int attempt = 0; attempt < kMostAttempts && !stop.stop_requested(); ++attempt) {
    if (settings.axes < 0) keepAxes(found.clusters, step);
    if (attempt > 0 && expandedBytes(found.clusters, shape) > settings.most_expanded_bytes) break;
    CodedTransfer coded = quantize(points, found.ids, found.clusters, basis, shape, step);
    coded.error = static_cast<float>(
        radianceError(vectors, decode(coded), shape, settings.shown_energy, settings.kernel_power));
    const float error = coded.error;
    const bool met = double{error} <= bound, met_before = double{best.error} <= bound;
    // The larger error is the smaller code, among those that keep the bound.
    if (attempt == 0 || (met ? !met_before || coded.error > best.error : coded.error < best.error))
      best = std::move(coded);
    if (settings.axes >= 0) break;  // no step makes up for axes that are left out
    if (met && double{best.error} > 0.98 * bound) break;
    if (best.planes.empty() && met) break;  // nothing left to save
    // Part of the error does not follow the step (rounded means and axes, the weaker of the two blocks): what
    // is missing has to come from the rest, so go down twice as far as the ratio says.
    const double ratio = 0.995 * bound / std::max(double{error}, 1e-12);
    step *= std::clamp(met ? ratio : ratio * ratio, 0.3, 1.5);
  }
  return best;
}

}  // namespace

CodedTransfer codeTransfer(std::span<const float> vectors, std::size_t count,
                           const bundle::TransferShape& shape, const CodingSettings& settings,
                           const std::stop_token& stop) {
  assert(count > 0 && vectors.size() == count * shape.size() && settings.bound > 0.0f);
  const WeightedSpace space = weightedSpace(vectors, shape, settings.shown_energy, settings.kernel_power);
  const double bound = double{settings.bound};
  const double allowed = bound * bound * space.blocks / static_cast<double>(count);

  // A basis for the cell: all principal components but those that hardly matter.
  double left_out = 0.0;
  const double size = static_cast<double>(shape.size());
  const std::size_t looked_at =
      shape.isVisibility() || shape.shadowed_channels == 0
          ? std::max(kBasisSamples, static_cast<std::size_t>(kBasisWork / (size * size)))
          : kBasisSamples;
  const Spectrum spectrum = leadingSpectrum(weighted(vectors, space.roots, someSamples(count, looked_at)),
                                            kTailShare * allowed, settings.most_components, left_out);
  // Where the components that were looked for leave out more than is allowed, the rest is coded to match.
  const double reachable = std::max(allowed, kBesideLeftOut * left_out);
  const double budget = 0.9 * (reachable - left_out);  // the rest: rounding of basis, means and axes
  Eigen::Index rank = spectrum.variances.size();
  for (double tail = left_out;
       rank > 0 && (tail += spectrum.variances(rank - 1)) <= left_out + kTailShare * allowed;)
    --rank;
  const double step = std::sqrt(12.0 * budget / static_cast<double>(std::max<Eigen::Index>(rank, 1)));
  const bundle::SharedCodebook basis =
      roundedBasis(spectrum.axes.leftCols(rank), spectrum.variances, space.roots, step);
  if (rank == 0) {  // dark
    CodedTransfer coded{shape, basis, std::vector<std::uint32_t>(count, 0), {}, 0.0f};
    coded.codebook.axis_counts = {0};
    coded.error = static_cast<float>(
        radianceError(vectors, decode(coded), shape, settings.shown_energy, settings.kernel_power));
    return coded;
  }

  const double least_bits = shape.glossy() ? kGlossyWeightBits : kPlainWeightBits;
  const Points points = coordinates(vectors, space.roots, basis);
  const auto fits = [&](const Clustering& one) {
    return expandedBytes(one.clusters, shape) <= settings.most_expanded_bytes;
  };
  const auto clustered = [&](std::uint32_t most) {
    const Clustering few = settings.clusters > 0
                               ? fromSome(points, settings.clusters, budget, settings.axes, least_bits)
                               : search(points, budget, least_bits, fits, most, stop);
    if (stop.stop_requested()) return Clustering{};
    return refine(points, assignClusters(points, few.clusters, few.step, {}), budget, settings.axes,
                  kFinalRounds, /*held_out=*/false, least_bits);
  };
  Clustering found = clustered(std::numeric_limits<std::uint32_t>::max());
  // What some of the samples foretold may be too little.
  while (settings.clusters == 0 && found.clusters.size() > 1 && !fits(found))
    found = clustered(static_cast<std::uint32_t>(found.clusters.size() / 2));
  if (stop.stop_requested()) return {};
  return fitToBound(vectors, points, found, basis, shape, settings, bound * std::sqrt(reachable / allowed),
                    stop);
}

}  // namespace lambent::baker
