#include "baker/compress/cpca.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <Eigen/Cholesky>

#include "baker/compress/cpca_clusters.hpp"
#include "baker/compress/cpca_quantize.hpp"
#include "baker/compress/cpca_space.hpp"
#include "baker/compress/cpca_spectrum.hpp"
#include "baker/work/parallel.hpp"

namespace lambent::baker {

namespace {

double knob(const char* n, double d) { const char* e = std::getenv(n); return e ? std::atof(e) : d; }

constexpr std::size_t kGrain = 512;
constexpr std::size_t kBasisSamples = 8192;  // see the covariance of the basis
constexpr std::size_t kSearchSamples = 8192, kRun = 64;
constexpr double kTailShare = 0.03;  // of the square error allowed, for what the basis leaves out

// Runs of neighbours spread over the cell: `kept` samples or all.
std::vector<std::uint32_t> someSamples(std::size_t count, std::size_t kept) {
  std::vector<std::uint32_t> samples;
  const std::size_t runs = (count + kRun - 1) / kRun, stride = std::max<std::size_t>(1, count / kept);
  for (std::size_t run = 0; run < runs; run += stride)
    for (std::size_t s = run * kRun; s < std::min(count, (run + 1) * kRun); ++s)
      samples.push_back(static_cast<std::uint32_t>(s));
  return samples;
}

Points weighted(std::span<const float> vectors, const std::vector<double>& roots, std::span<const std::uint32_t> samples) {
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
  const auto size = static_cast<Eigen::Index>(roots.size()), rank = static_cast<Eigen::Index>(basis.basis_scales.size());
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
    points.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin)).noalias() = project * block;
  });
  return points;
}

struct Clustering {
  ClusterIds ids;
  std::vector<Cluster> clusters;
  double step = 0.0, bytes = 0.0;
};

Clustering refine(const Points& points, ClusterIds ids, double budget, int rounds, double count) {
  Clustering c{std::move(ids), {}, 0.0, 0.0};
  for (int round = 0;; ++round) {
    c.clusters = fitClusters(points, c.ids);
    c.step = stepFor(c.clusters, budget);
    if (round == rounds || c.clusters.size() == 1) break;
    c.ids = assignClusters(points, c.clusters, c.step, c.ids);
  }
  c.bytes = expectedBytes(c.clusters, c.step, count);
  return c;
}

std::vector<float> decode(const CodedTransfer& coded) {
  std::vector<std::vector<std::uint32_t>> codes;
  for (const CodedPlane& plane : coded.planes) codes.push_back(plane.codes);
  return bundle::decodeTransfer(coded.shape, bundle::expand(coded.codebook), coded.cluster_of, codes);
}

}  // namespace

CodedTransfer codeTransfer(std::span<const float> vectors, std::size_t count,
                           const bundle::TransferShape& shape, const CodingSettings& settings,
                           const std::stop_token& stop) {
  assert(count > 0 && vectors.size() == count * shape.size() && settings.bound > 0.0f);
  const WeightedSpace space = weightedSpace(vectors, shape);
  const double allowed = double{settings.bound} * double{settings.bound} / static_cast<double>(count);
  const double budget = 0.9 * allowed;

  const auto some = someSamples(count, kBasisSamples);
  const Spectrum spectrum = spectrumOf(secondMoment(weighted(vectors, space.roots, some), {}, {}));
  Eigen::Index rank = spectrum.variances.size();
  for (double tail = 0.0; rank > 0 && (tail += spectrum.variances(rank - 1)) <= kTailShare * allowed;) --rank;
  double step = std::sqrt(12.0 * budget / static_cast<double>(std::max<Eigen::Index>(rank, 1)));
  const bundle::SharedCodebook basis = roundedBasis(spectrum.axes.leftCols(rank), spectrum.variances, space.roots, step);
  const Points points = coordinates(vectors, space.roots, basis);
  if (knob("VERBOSE", 0)) std::printf("rank %d\n", int(rank));

  const auto searched = someSamples(count, size_t(knob("SUB", 8192)));
  Points sub(rank, static_cast<Eigen::Index>(searched.size()));
  for (std::size_t s = 0; s < searched.size(); ++s) sub.col(static_cast<Eigen::Index>(s)) = points.col(searched[s]);
  Clustering best;
  const auto n = static_cast<double>(count);
  if (settings.clusters > 0) {
    best = refine(sub, seedClusters(sub, settings.clusters), budget, int(knob("IT",8)), n);
  } else {
    for (const std::uint32_t clusters : {1u, 4u, 16u, 64u, 128u, 256u}) {
      if (stop.stop_requested()) return {};
      Clustering tried = refine(sub, seedClusters(sub, clusters), budget, 6, n);
      if (knob("VERBOSE", 0)) std::printf("  %u -> %zu clusters: %.2f bytes per sample\n", clusters, tried.clusters.size(), tried.bytes / n);
      if (clusters == 1 || tried.bytes < best.bytes) best = std::move(tried);
      else if (tried.bytes > 1.1 * best.bytes) break;
    }
  }
  Clustering all = refine(points, assignClusters(points, best.clusters, best.step, {}), budget, int(knob("IT2",2)), n);
  if (knob("VERBOSE", 0)) std::printf("  all: %zu clusters: %.2f bytes per sample, step %g\n", all.clusters.size(), all.bytes / n, all.step);

  CodedTransfer coded;
  step = all.step;
  for (int attempt = 0; attempt < 6 && !stop.stop_requested(); ++attempt) {
    keepAxes(all.clusters, step);
    coded = quantize(points, all.ids, all.clusters, basis, shape, step);
    coded.error = static_cast<float>(radianceError(vectors, decode(coded), shape));
    if (knob("VERBOSE", 0)) std::printf("  step %g error %.4f %%\n", step, 100 * double{coded.error});
    const double ratio = double{settings.bound} / double{coded.error};
    if (ratio >= 1.0 && (ratio < 1.02 || attempt >= 3)) break;
    step *= 0.995 * ratio;
  }
  return coded;
}

}  // namespace lambent::baker
