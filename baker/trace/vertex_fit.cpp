#include "baker/trace/vertex_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/SparseCore>

#include "baker/jobs/parallel.hpp"
#include "baker/transport/face_points.hpp"

namespace lambent::baker {

namespace {

// The triangles that get a point have this share of all squared change between corners.
constexpr double kShareOfChange = 0.99;
// Limit on the squared relative change: smaller ones are rounding, and noise of rays that hit the same
// things.
constexpr double kLeastChange = 1e-6;
// Weights of the corners and of the centroid in a triangle's integral.
constexpr double kOfCorner = 1.0 / 12.0, kOfCentroid = 3.0 / 4.0;
// Values are solved for by Chebyshev semi-iteration (Wathen and Rees 2009). Relative to their diagonal, mass
// matrices of linear functions on triangles have eigenvalues from 1/2 to 2 (Wathen 1987), so each step takes
// away two thirds of the error. What is left is far below the noise of rays.
constexpr int kSteps = 9;
constexpr float kLeast = 0.5f, kMost = 2.0f;
// Number of values of each sample that are solved for together.
constexpr std::size_t kTogether = 16;
using Row = std::array<float, kTogether>;

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
  using Matrix = Eigen::SparseMatrix<float, Eigen::RowMajor, int>;
  struct Point {
    glm::uvec3 corners;   // samples, relative to the first of the stretch
    std::uint32_t point;  // relative to the first of its stretch
    float weight;
  };
  std::size_t unknowns = 0;
  std::vector<Point> points;
  Matrix mass;
  std::vector<float> over_diagonal;

  // Replaces b by the solution x of mass x = b.
  void solve(std::vector<Row>& b) const;
};

void VertexFit::System::solve(std::vector<Row>& b) const {
  constexpr float kRelax = 2.0f / (kLeast + kMost), kRho = (kMost - kLeast) / (kMost + kLeast);
  std::vector<Row> now(unknowns, Row{}), before(unknowns, Row{});
  float omega = 1.0f;
  for (int step = 0; step < kSteps; ++step) {
    // `before` is overwritten by the values that follow `now`.
    for (std::size_t s = 0; s < unknowns; ++s) {
      Row left = b[s];
      for (Matrix::InnerIterator term(mass, static_cast<Eigen::Index>(s)); term; ++term) {
        const Row& other = now[static_cast<std::size_t>(term.col())];
        const float weight = term.value();
        for (std::size_t i = 0; i < kTogether; ++i) left[i] -= weight * other[i];
      }
      const float share = kRelax * over_diagonal[s];
      for (std::size_t i = 0; i < kTogether; ++i)
        before[s][i] += omega * (now[s][i] + share * left[i] - before[s][i]);
    }
    std::swap(now, before);
    omega = step == 0 ? 1.0f / (1.0f - 0.5f * kRho * kRho) : 1.0f / (1.0f - 0.25f * kRho * kRho * omega);
  }
  b = std::move(now);
}

VertexFit::VertexFit(const GroupGeometry& geometry, const SampleSet& samples, SampleStretch stretch,
                     const FacePoints& points, SampleStretch points_stretch,
                     std::span<const std::uint8_t> valid) {
  auto system = std::make_unique<System>();
  system->unknowns = stretch.size();
  std::vector<Eigen::Triplet<float>> terms;
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
                           static_cast<float>(area * (kOfCentroid / 9.0 + (a == b ? kOfCorner : 0.0))));
  }
  const auto size = static_cast<Eigen::Index>(system->unknowns);
  system->mass.resize(size, size);
  system->mass.setFromTriplets(terms.begin(), terms.end());
  for (Eigen::Index s = 0; s < size; ++s) {
    const float diagonal = system->mass.coeff(s, s);
    // A sample with no face, or only faces without a usable area, keeps its value.
    system->over_diagonal.push_back(std::isnormal(diagonal) ? 1.0f / diagonal : 0.0f);
  }
  for (std::size_t p = points_stretch.begin; p < points_stretch.end; ++p) {
    if (valid[p] == 0) continue;
    const glm::uvec3 triangle = geometry.triangles[points.triangles[p]];
    system->points.push_back({samplesOf(samples, triangle) - glm::uvec3(static_cast<unsigned>(stretch.begin)),
                              static_cast<std::uint32_t>(p - points_stretch.begin),
                              static_cast<float>(kOfCentroid * triangleArea(geometry, triangle))});
  }
  system_ = std::move(system);
}

VertexFit::~VertexFit() = default;

bool VertexFit::apply(std::size_t width, std::span<const float> at_points, std::span<float> values,
                      const std::stop_token& stop) const {
  if (system_->points.empty()) return !stop.stop_requested();
  return parallelRanges(width, kTogether, stop, [&](std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    std::vector<Row> change(system_->unknowns, Row{});
    for (const System::Point& point : system_->points) {
      const float* there = at_points.data() + point.point * width + begin;
      std::array<const float*, 3> corners;
      for (int c = 0; c < 3; ++c)
        corners[static_cast<std::size_t>(c)] = values.data() + point.corners[c] * width + begin;
      for (std::size_t i = 0; i < count; ++i) {
        const float lack = there[i] - (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0f;
        for (int c = 0; c < 3; ++c) change[point.corners[c]][i] += point.weight * lack / 3.0f;
      }
    }
    system_->solve(change);
    for (std::size_t s = 0; s < system_->unknowns; ++s)
      for (std::size_t i = 0; i < count; ++i) values[s * width + begin + i] += change[s][i];
  });
}

}  // namespace lambent::baker
