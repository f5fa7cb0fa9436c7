#include "baker/effects/diffuse/vertex_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include "baker/transport/sample_areas.hpp"
#include "baker/work/parallel.hpp"

namespace lambent::baker {

namespace {

// Of the square of all change between corners, so much lies on the triangles that get a point.
constexpr double kShareOfChange = 0.98;
// Squared, relative: what is less is rounding, and noise of rays at the same things.
constexpr double kLeastChange = 1e-6;
// Of a triangle's integral.
constexpr double kOfCorner = 1.0 / 12.0, kOfCentroid = 3.0 / 4.0;
// Far below the noise of rays; mass matrices take some ten steps.
constexpr double kTolerance = 1e-4;

glm::uvec3 samplesOf(const SampleSet& samples, const glm::uvec3& corners) {
  return {samples.vertex_sample[corners.x], samples.vertex_sample[corners.y],
          samples.vertex_sample[corners.z]};
}

}  // namespace

std::vector<std::uint32_t> changingTriangles(const GroupGeometry& geometry, const SampleSet& samples,
                                             SampleStretch stretch, std::size_t width,
                                             std::span<const float> values) {
  const std::size_t count = geometry.triangles.size();
  std::vector<double> change(count, 0.0);
  parallelRanges(count, 1024, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const glm::uvec3 corners = samplesOf(samples, geometry.triangles[t]);
      if (corners.x < stretch.begin || corners.x >= stretch.end) continue;
      const auto at = [&](int c) { return values.subspan((corners[c] - stretch.begin) * width, width); };
      const auto a = at(0), b = at(1), c = at(2);
      double sum = 0.0, all = 0.0;
      for (std::size_t i = 0; i < width; ++i) {
        const double ab = double{a[i]} - double{b[i]}, bc = double{b[i]} - double{c[i]},
                     ca = double{c[i]} - double{a[i]};
        sum += ab * ab + bc * bc + ca * ca;
        all += double{a[i]} * double{a[i]} + double{b[i]} * double{b[i]} + double{c[i]} * double{c[i]};
      }
      if (sum > kLeastChange * all) change[t] = triangleArea(geometry, geometry.triangles[t]) * sum;
    }
  });
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return change[a] > change[b]; });
  double left = kShareOfChange * std::accumulate(change.begin(), change.end(), 0.0);
  std::size_t taken = 0;
  while (taken < count && left > 0.0 && change[order[taken]] > 0.0) left -= change[order[taken++]];
  order.resize(taken);
  std::sort(order.begin(), order.end());
  return order;
}

struct VertexFit::System {
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  struct Point {
    glm::uvec3 corners;   // from the stretch's first sample on
    std::uint32_t point;  // from its stretch's first on
    double weight;
  };
  std::size_t unknowns = 0;
  std::vector<Point> points;
  Matrix mass;
};

VertexFit::VertexFit(const GroupGeometry& geometry, const SampleSet& samples, SampleStretch stretch,
                     const FacePoints& points, SampleStretch points_stretch,
                     std::span<const std::uint8_t> valid) {
  auto system = std::make_unique<System>();
  system->unknowns = stretch.size();
  std::vector<Eigen::Triplet<double>> terms;
  terms.reserve(12 * geometry.triangles.size());
  for (const glm::uvec3& triangle : geometry.triangles) {
    const glm::uvec3 corners = samplesOf(samples, triangle);
    if (corners.x < stretch.begin || corners.x >= stretch.end) continue;
    const double area = triangleArea(geometry, triangle);
    if (!(area > 0.0)) continue;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        terms.emplace_back(static_cast<int>(corners[a] - stretch.begin),
                           static_cast<int>(corners[b] - stretch.begin),
                           area * (kOfCentroid / 9.0 + (a == b ? kOfCorner : 0.0)));
  }
  std::vector<double> touched(system->unknowns, 0.0);
  for (const auto& term : terms)
    if (term.row() == term.col()) touched[static_cast<std::size_t>(term.row())] += term.value();
  for (std::size_t s = 0; s < touched.size(); ++s)  // of no face: stays
    if (!(touched[s] > 0.0)) terms.emplace_back(static_cast<int>(s), static_cast<int>(s), 1.0);
  const auto size = static_cast<Eigen::Index>(system->unknowns);
  system->mass.resize(size, size);
  system->mass.setFromTriplets(terms.begin(), terms.end());
  for (std::size_t p = points_stretch.begin; p < points_stretch.end; ++p) {
    if (valid[p] == 0) continue;
    const glm::uvec3 triangle = geometry.triangles[points.triangles[p]];
    system->points.push_back({samplesOf(samples, triangle) - glm::uvec3(static_cast<unsigned>(stretch.begin)),
                              static_cast<std::uint32_t>(p - points_stretch.begin),
                              kOfCentroid * triangleArea(geometry, triangle)});
  }
  system_ = std::move(system);
}

VertexFit::~VertexFit() = default;

bool VertexFit::apply(std::size_t width, std::span<const float> at_points, std::span<float> values,
                      const std::stop_token& stop) const {
  if (system_->points.empty()) return !stop.stop_requested();
  return parallelRanges(width, 1, stop, [&](std::size_t begin, std::size_t end) {
    Eigen::ConjugateGradient<System::Matrix, Eigen::Lower | Eigen::Upper> solver;
    solver.setTolerance(kTolerance);
    solver.compute(system_->mass);
    for (std::size_t i = begin; i < end; ++i) {
      Eigen::VectorXd lacks = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system_->unknowns));
      for (const System::Point& point : system_->points) {
        double lack = double{at_points[point.point * width + i]};
        for (int c = 0; c < 3; ++c) lack -= double{values[point.corners[c] * width + i]} / 3.0;
        for (int c = 0; c < 3; ++c) lacks[point.corners[c]] += point.weight * lack / 3.0;
      }
      const Eigen::VectorXd change = solver.solve(lacks);
      for (std::size_t s = 0; s < system_->unknowns; ++s)
        values[s * width + i] += static_cast<float>(change[static_cast<Eigen::Index>(s)]);
    }
  });
}

}  // namespace lambent::baker
