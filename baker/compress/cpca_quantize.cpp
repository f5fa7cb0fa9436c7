#include "baker/compress/cpca_quantize.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <Eigen/Cholesky>

#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr double kLargestCoordinate = transfer::kMaxCoordinate - 1;
constexpr double kMaxCode = 65535.0;

std::int32_t rounded(double value) {
  return static_cast<std::int32_t>(std::lround(std::clamp(value, -kLargestCoordinate, kLargestCoordinate)));
}

// Rounds to quarter octaves, since few different values code to few bytes.
double coarse(double value) {
  return std::exp2(std::round(4.0 * std::log2(value)) / 4.0);
}

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

}  // namespace

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

}  // namespace lambent::baker
