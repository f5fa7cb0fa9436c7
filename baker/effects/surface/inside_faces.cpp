#include "baker/effects/surface/inside_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/SparseCore>
#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

namespace {

// The triangles that get a point have this share of all squared change between corners.
constexpr double kShareOfChange = 0.99;
// Limit on the squared relative change: smaller ones are rounding, and noise of rays that hit the same
// things.
constexpr double kLeastSquaredChange = 1e-6;
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
      if (sum > kLeastSquaredChange * all) change[t] = triangleArea(geometry, geometry.triangles[t]) * sum;
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
  void solve(std::vector<Row>& b) const {
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
};

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

TracedPoints::TracedPoints(const TracedScene& scene, FacePoints points, const DirectSettings& settings)
    : points_(std::move(points)), scene_(scene.withSamples(points_.samples)), pass_(scene_, settings) {}

bool TracedPoints::look(const BakeContext& context, const char* stage) {
  direct = pass_.untraced();
  return traceDirect(pass_, context, stage, direct);
}

namespace {

// RMS of the change of direct light along a triangle's edges, relative to the light at its corners. Where it
// changes little from corner to corner it is nearly linear, and a fit gains nothing: on scans of 50,000
// vertices it would cost as much as the vertices.
constexpr float kLeastChange = 0.15f;
// Mostly bounced light comes to a triangle that gets less than this share of open light. It is large if an
// edge is at least this share of the extent of what is seen.
constexpr float kMostOpen = 0.5f, kLargeEdge = 1.0f / 256.0f;
// Uniform light of radiance 1 has sqrt(4 pi) as its coefficient 0 and no others.
constexpr float kUniform = 3.54490770f;

float squaredLength(std::span<const float> vector) {
  float sum = 0.0f;
  for (const float value : vector) sum += value * value;
  return sum;
}

float squaredDistance(std::span<const float> a, std::span<const float> b) {
  float sum = 0.0f;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

// Returns the largest share, at most 1, of the way between two vectors at which the coefficient 0 of every
// channel is still between 0 and `most`, if it is so at the first.
float shareWithin(std::span<const float> from, std::span<const float> to, std::size_t columns, float most) {
  float share = 1.0f;
  for (std::size_t at = 0; at < from.size(); at += columns) {
    const float bound = to[at] < 0.0f ? 0.0f : most;
    if (to[at] >= 0.0f && to[at] <= most) continue;
    share = std::min(share, std::clamp((bound - from[at]) / (to[at] - from[at]), 0.0f, 1.0f));
  }
  return share;
}

// The same rays are traced as at the vertices. Bounces at diffuse points gather over a part of them, since
// neighbours even out the noise of fewer hits.
DirectSettings settingsInside(DirectSettings settings, std::size_t hit_memory) {
  settings.hit_memory = hit_memory;
  settings.hits_of_every = kThinned;
  return settings;
}

template <typename Values>
auto partOf(Values& values, const SampleStretch& stretch, std::size_t width) {
  return std::span(values).subspan(stretch.begin * width, stretch.size() * width);
}

std::array<SampleStretch, 3> stretchesOf(const SampleSet& samples) {
  return {samples.diffuse, samples.normal_mapped, samples.glossy};
}

// Returns, in ascending order, the triangles of matte draws over which light may change much: those over
// which direct light does, and large ones to which mostly bounced light comes. Colours have no say, so that
// after a change of colours no ray is traced again.
std::vector<std::uint32_t> changingMatte(const TracedScene& scene, const TransferField& direct) {
  const GroupGeometry& geometry = scene.geometry;
  const SampleSet& samples = scene.samples;
  const float large =
      kLargeEdge *
      (scene.importance ? scene.importance->extent : glm::distance(geometry.bounds_min, geometry.bounds_max));
  const std::size_t width = direct.vectorSize();
  std::vector<std::uint8_t> changes(geometry.triangles.size(), 0);
  for (const SampleStretch& stretch : {samples.diffuse, samples.normal_mapped})
    for (const std::uint32_t t :
         changingTriangles(geometry, samples, stretch, width, partOf(direct.vectors, stretch, width)))
      changes[t] = 1;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
    const glm::uvec3 corners = geometry.triangles[t];
    if (samples.vertex_sample[corners.x] >= samples.glossy.begin || !scene.matters(t)) continue;
    float change = 0.0f, light = 0.0f, open = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const auto here = direct.at(samples.vertex_sample[corners[c]]);
      change += squaredDistance(here, direct.at(samples.vertex_sample[corners[(c + 1) % 3]]));
      light += squaredLength(here);
      open += kUniform * here[0] / 3.0f;
    }
    if ((changes[t] != 0 && change >= kLeastChange * kLeastChange * light) ||
        (open < kMostOpen && longestEdge(geometry, corners) >= large))
      triangles.push_back(t);
  }
  return triangles;
}

std::vector<std::uint32_t> changingGlossy(const TracedScene& scene, const GlossyField& direct) {
  auto triangles = changingTriangles(scene.geometry, scene.samples, scene.samples.glossy,
                                     direct.visibilitySize(), direct.visibility);
  std::erase_if(triangles, [&](std::uint32_t t) { return !scene.matters(t); });
  return triangles;
}

}  // namespace

InsideFaces::InsideFaces(const DirectPass& vertices, SurfacePart part,
                         std::span<const std::uint32_t> triangles, std::size_t hit_memory)
    : vertices_(vertices.scene()),
      part_(part),
      points_(vertices_, facePoints(vertices_.geometry, vertices_.samples, triangles),
              settingsInside(vertices.settings(), hit_memory)) {}

bool InsideFaces::look(const BakeContext& context) {
  if (!points_.look(context, "inside faces")) return false;
  const auto of_vertices = stretchesOf(vertices_.samples), of_points = stretchesOf(points_.points().samples);
  for (std::size_t kind = 0; kind < of_vertices.size(); ++kind) {
    if (of_points[kind].empty()) continue;
    fits_[kind].emplace(vertices_.geometry, vertices_.samples, of_vertices[kind], points_.points(),
                        of_points[kind], points_.direct.looks.valid);
  }
  return true;
}

bool InsideFaces::fitDirect(DirectResult& at_vertices, const std::stop_token& stop) {
  DirectResult& found = points_.direct;
  if (part_ == SurfacePart::Matte)
    return fit(found.field, 1.0f, at_vertices.field, stop) &&
           fit(SampleKind::NormalMapped, found.mapped.vectors, at_vertices.mapped.vectors, stop);
  // Bounces need no direct light of points, whose visibility is large.
  const std::vector<float> visibility = std::exchange(found.glossy.visibility, {}),
                           lights = std::exchange(found.glossy.lights_shadowed, {});
  return fit(SampleKind::Glossy, visibility, at_vertices.glossy.visibility, stop) &&
         fit(SampleKind::Glossy, lights, at_vertices.glossy.lights_shadowed, stop);
}

bool InsideFaces::fit(const TransferField& at_points, float most, TransferField& at_vertices,
                      const std::stop_token& stop) const {
  const SampleSet &of_points = points_.points().samples, &of_vertices = vertices_.samples;
  const std::size_t width = at_vertices.vectorSize();
  const TransferField before = at_vertices;
  const auto fitStretch = [&](SampleKind kind, const SampleStretch& from, const SampleStretch& to) {
    return fit(kind, partOf(at_points.vectors, from, width), partOf(at_vertices.vectors, to, width), stop);
  };
  if (!fitStretch(SampleKind::Diffuse, of_points.diffuse, of_vertices.diffuse) ||
      !fitStretch(SampleKind::NormalMapped, of_points.normal_mapped, of_vertices.normal_mapped))
    return false;
  for (std::size_t s = 0; s < of_vertices.glossy.begin; ++s) {
    const auto from = before.at(s);
    const auto to = at_vertices.at(s);
    const float share = shareWithin(from, to, before.columns, most / kUniform);
    if (share < 1.0f)
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[i] + share * (to[i] - from[i]);
  }
  return true;
}

bool InsideFaces::fit(SampleKind kind, std::span<const float> at_points, std::span<float> at_vertices,
                      const std::stop_token& stop) const {
  const auto index = static_cast<std::size_t>(kind);
  if (at_vertices.empty() || !fits_[index]) return true;
  const std::size_t width = at_vertices.size() / stretchesOf(vertices_.samples)[index].size();
  return fits_[index]->apply(width, at_points, at_vertices, stop);
}

bool fitInsideFaces(const DirectPass& vertices, SurfacePart part, const BakeContext& context,
                    DirectResult& direct, std::unique_ptr<InsideFaces>& inside) {
  const auto triangles = part == SurfacePart::Glossy ? changingGlossy(vertices.scene(), direct.glossy)
                                                     : changingMatte(vertices.scene(), direct.field);
  if (triangles.empty()) return true;
  KeyMaker key = KeyMaker::ofStage("inside faces");
  const BakeContext own =
      context.keeps() ? context.keyed(key.add(context.key).addList(triangles).key()) : context;
  inside = std::make_unique<InsideFaces>(vertices, part, triangles, direct.of(part).hits.bytesLeft());
  return inside->look(own) && inside->fitDirect(direct, context.stop);
}

}  // namespace lambent::baker
