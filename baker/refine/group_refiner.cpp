#include "baker/refine/group_refiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/transport/face_points.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/sample_areas.hpp"

namespace lambent::baker {

namespace {

// A triangle is probed at n² points if its longest edge is n times this share of the group's diagonal.
constexpr float kProbeSpacing = 1.0f / 32.0f;
constexpr int kMostProbesAlong = 8;
constexpr std::uint32_t kUnused = 0xffffffffu;  // a sample of no triangle that is looked at
// Triangles whose longest edge is below this share of the diagonal are not looked at. In a furnished room
// they are two thirds of all, have a hundredth of the area, and show shadows as they are.
constexpr float kShortestEdge = 1.0f / 512.0f;
// Light is never taken to be less than this share of that of an open point: what bounces brightens the dark.
constexpr double kLeastLight = 0.07;
// Errors at glossy points count by this factor. What few bands leave of a highlight hides them: a body of
// gold has the same picture with a quarter of the samples (docs/decisions/vertices.md), and each costs a
// matrix.
constexpr double kGlossyCounts = 0.4;
// A split triangle splits its edges of at least this share of the longest one.
constexpr float kSplitShare = 0.6f;
// A vertex stands before a surface that cuts its face by this share of the diagonal, which is a few steps of
// the lattice of positions. An edge that begins nearer than this many times as far before it is not cut
// again.
constexpr float kBeforeCut = 1.0f / 32768.0f, kLeastCut = 2.0f;
// Edges of bad triangles are cut up to this share of the diagonal.
constexpr float kLongestCut = 1.0f / 16.0f;
// Light leaks to a corner that has less than this share of the light of another, if that has at least this
// share of the light of an open point.
constexpr float kDarkShare = 0.05f, kLightShare = 0.05f;
// A round splits triangles until the remaining square error is this share of what is allowed, or this share
// of all of it if that is more, because what the first splits show decides where the next ones go.
constexpr double kLeftOfAllowed = 0.6, kLeftOfAll = 0.35;
// Many rays do not look at the triangles whose errors, as few rays show them with noise, make up this share
// of all error, or of what is allowed if that is more.
// Nor do they look where the square error is so many times what noise adds to it: few rays are enough to
// tell.
constexpr double kOverlooked = 0.1, kBeyondDoubt = 2.0;

// An InnerPoint is a point inside a triangle, by the weights of its corners.
struct InnerPoint {
  glm::vec3 weights;
};

// Returns the centres of n² equal parts of a triangle.
std::vector<InnerPoint> innerPoints(int n) {
  std::vector<InnerPoint> points;
  const float part = 1.0f / (3.0f * static_cast<float>(n));
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const auto add = [&](int a, int b) {
        const float u = static_cast<float>(a) * part, v = static_cast<float>(b) * part;
        points.push_back({{1.0f - u - v, u, v}});
      };
      add(3 * i + 1, 3 * j + 1);
      if (i + j + 1 < n) add(3 * i + 2, 3 * j + 2);
    }
  return points;
}

// Returns a unit normal, or 0 for a triangle without area.
glm::vec3 unitNormal(const GroupGeometry& geometry, std::uint32_t triangle) {
  const glm::vec3 normal = areaNormal(geometry, geometry.triangles[triangle]);
  const float length = glm::length(normal);
  return length > 0.0f ? normal / length : glm::vec3(0.0f);
}

// Returns all numbers below `count`.
std::vector<std::uint32_t> allOf(std::size_t count) {
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

// Gives samples that cannot be seen the most light of their neighbours, as fill.hpp may, and of theirs.
void lightUnseen(const GroupGeometry& geometry, const SampleSet& samples,
                 std::span<const std::uint32_t> triangles, std::span<const std::uint8_t> seen,
                 std::vector<float>& light) {
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<float> before = light;
    for (const std::uint32_t t : triangles) {
      const glm::uvec3 corners = geometry.triangles[t];
      for (int c = 0; c < 3; ++c)
        if (const std::uint32_t s = samples.vertex_sample[corners[c]]; seen[s] == 0)
          for (int k = 1; k < 3; ++k)
            light[s] = std::max(light[s], before[samples.vertex_sample[corners[(c + k) % 3]]]);
    }
  }
}

std::vector<SampleKind> kindsOf(const SampleSet& samples) {
  std::vector<SampleKind> kinds(samples.size());
  for (const SampleCell& cell : samples.cells) std::fill_n(kinds.begin() + cell.first, cell.count, cell.kind);
  return kinds;
}

// Returns the number of each sample at a corner of these triangles as a point that is probed, else kUnused.
std::vector<std::uint32_t> cornerPoints(ProbedPoints& points, const GroupGeometry& geometry,
                                        const SampleSet& samples, std::span<const SampleKind> kinds,
                                        std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> numbers(samples.size(), kUnused);
  for (const std::uint32_t t : triangles)
    for (int c = 0; c < 3; ++c)
      if (const std::uint32_t s = samples.vertex_sample[geometry.triangles[t][c]]; numbers[s] == kUnused)
        numbers[s] =
            points.numberOf(samples.positions[s], samples.normals[s], kinds[s], samples.originsOf(s));
  return numbers;
}

// Squares of what is wrong at a point, relative to the light there.
struct PointError {
  double square = 0.0;      // without bias from noise
  double with_noise = 0.0;  // of what all rays together show
};

PointError pointError(const ShadowProbe::Difference& wrong, const ShadowProbe::Difference& arriving) {
  const double light = std::max(ShadowProbe::squareError(arriving), 0.0) + kLeastLight * kLeastLight;
  PointError error{.square = ShadowProbe::squareError(wrong) / light};
  for (std::size_t i = 0; i < ShadowProbe::kMostValues; ++i) {
    const double both = 0.5 * (double{wrong[0][i]} + double{wrong[1][i]});
    error.with_noise += both * both / light;
  }
  return error;
}

}  // namespace

void GroupRefiner::prepare(const GroupGeometry& geometry, const Scene& scene, const AlphaMaps& alpha_maps) {
  diagonal_ = glm::distance(geometry.bounds_min, geometry.bounds_max);
  scene_normals_.clear();
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t)
    scene_normals_.push_back(unitNormal(geometry, t));
  KeyMaker key = KeyMaker::ofStage("refinement probes");
  addShape(geometry, key);
  addOpacity(scene, geometry, key);
  scene_.emplace(key.key(),
                 [geometry, &scene, &alpha_maps] { return RayScene::build(geometry, scene, alpha_maps); });
}

std::vector<std::uint32_t> GroupRefiner::triangles(const GroupGeometry& geometry) const {
  std::vector<std::uint32_t> triangles;
  for (const DrawGeometry& draw : geometry.draws) {
    if (draw.texels > 0 || (draw.kind == SampleKind::Glossy && !with_glossy_)) continue;
    for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t)
      if (longestEdge(geometry, geometry.triangles[t]) >= kShortestEdge * diagonal_) triangles.push_back(t);
  }
  return triangles;
}

double GroupRefiner::squareError() const {
  double sum = 0.0;
  for (const Measured& measured : measured_) sum += measured.square_error;
  return sum;
}

double GroupRefiner::seenArea() const {
  double sum = 0.0;
  for (const Measured& measured : measured_) sum += measured.seen;
  return sum;
}

double GroupRefiner::relativeError() const {
  const double area = seenArea();
  return area > 0.0 ? std::sqrt(std::max(0.0, squareError()) / area) : 0.0;
}

Result<bool> GroupRefiner::measure(const GroupGeometry& geometry, double bound, const BakeContext& context) {
  const SampleSet samples = buildSamples(geometry, /*with_texels=*/false);
  const std::size_t count = geometry.triangles.size();
  measured_.assign(count, {});
  if (for_wedges_) {
    triangle_area_.assign(count, 0.0);
    triangle_lack_.assign(count * 2 * kLackValues, 0.0f);
  }
  const auto by_few = measureBy(few_, geometry, samples, triangles(geometry), context);
  if (!by_few || !*by_few) return by_few;
  const double allowed = bound * bound * seenArea();
  if (!chosen_ && squareError() <= allowed) return true;
  std::vector<std::uint32_t> again = trianglesThatMatter(std::max(allowed, squareError()));
  std::erase_if(again, [&](std::uint32_t t) {
    return samples.vertex_sample[geometry.triangles[t].x] >= samples.glossy.begin;
  });
  return measureBy(many_, geometry, samples, again, context);
}

std::vector<std::uint32_t> GroupRefiner::trianglesThatMatter(double square_error) const {
  std::vector<std::uint32_t> order = allOf(measured_.size());
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return measured_[a].with_noise < measured_[b].with_noise;
  });
  double overlooked = 0.0;
  const auto matters = std::find_if(order.begin(), order.end(), [&](std::uint32_t t) {
    overlooked += measured_[t].with_noise;
    return overlooked > kOverlooked * square_error;
  });
  order.erase(order.begin(), matters);
  std::erase_if(order, [&](std::uint32_t t) {
    const Measured& measured = measured_[t];
    return measured.square_error > kBeyondDoubt * std::max(measured.with_noise - measured.square_error, 0.0);
  });
  std::sort(order.begin(), order.end());
  return order;
}

Result<bool> GroupRefiner::measureBy(ProbedPoints& points, const GroupGeometry& geometry,
                                     const SampleSet& samples, std::span<const std::uint32_t> triangles,
                                     const BakeContext& context) {
  const std::vector<SampleKind> kinds = kindsOf(samples);
  const std::vector<std::uint32_t> of_sample = cornerPoints(points, geometry, samples, kinds, triangles);
  std::vector<Inner> inner;
  for (const std::uint32_t t : triangles) {
    const glm::uvec3 corners = geometry.triangles[t];
    const SampleKind kind = kinds[samples.vertex_sample[corners.x]];
    const int along =
        std::clamp(static_cast<int>(std::ceil(longestEdge(geometry, corners) / (kProbeSpacing * diagonal_))),
                   1, kMostProbesAlong);
    for (const InnerPoint& point : innerPoints(along)) {
      const FacePoint at = facePoint(geometry, corners, point.weights);
      inner.push_back({t, points.numberOf(at.position, at.normal, kind, std::span(&at.origin, 1)),
                       point.weights, at.normal});
    }
  }
  if (auto probed = points.probe(*scene_, context); !probed || !*probed) return probed;

  const ShadowProbe& probe = points.shadowProbe();
  std::vector<PointError> error_at(inner.size());
  std::vector<float> lack_at(for_wedges_ ? inner.size() * 2 * kLackValues : 0);
  std::vector<std::uint8_t> seen_at(inner.size(), 0);
  // Points that cannot be seen have no error, and unseen corners take the values of their neighbours
  // (fill.hpp).
  const auto measureAt = [&](std::size_t i) {
    const Inner& point = inner[i];
    std::array<HiddenFrom, 3> corners;
    float shares = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t sample = samples.vertex_sample[geometry.triangles[point.triangle][c]],
                          number = of_sample[sample];
      HiddenFrom& corner = corners[static_cast<std::size_t>(c)];
      corner = {points.masksAt(number), samples.normals[sample],
                points.seen(number) ? point.weights[c] : 0.0f};
      shares += corner.share;
    }
    if (!points.seen(point.point) || !(shares > 0.0f)) return;
    for (HiddenFrom& corner : corners) corner.share /= shares;
    const HiddenFrom truth{points.masksAt(point.point), point.normal};
    const SampleKind kind = kinds[samples.vertex_sample[geometry.triangles[point.triangle].x]];
    const auto wrong = probe.difference(corners, truth, kind);
    error_at[i] = pointError(wrong, probe.arriving(truth, kind));
    if (kind == SampleKind::Glossy) {
      error_at[i].square *= kGlossyCounts * kGlossyCounts;
      error_at[i].with_noise *= kGlossyCounts * kGlossyCounts;
    }
    seen_at[i] = 1;
    if (for_wedges_)
      for (std::size_t half = 0; half < 2; ++half)
        std::copy_n(wrong[half].begin(), kLackValues, lack_at.data() + (2 * i + half) * kLackValues);
  };
  const bool done =
      parallelRanges(inner.size(), kPointsPerRange, context.stop, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) measureAt(i);
      });
  if (!done) return false;

  for (std::size_t first = 0, last = 0; first < inner.size(); first = last) {
    const std::uint32_t t = inner[first].triangle;
    Measured sums;
    for (; last < inner.size() && inner[last].triangle == t; ++last) {
      sums.square_error += error_at[last].square;
      sums.with_noise += error_at[last].with_noise;
      sums.seen += seen_at[last];
    }
    const double part =
        triangleArea(geometry, geometry.triangles[t]) / static_cast<double>(last - first);  // of a point
    measured_[t] = {part * sums.square_error, part * sums.with_noise, part * sums.seen};
  }
  if (for_wedges_) keepLacks(geometry, inner, seen_at, lack_at);
  return true;
}

// Keeps the mean over the points of each triangle that can be seen.
void GroupRefiner::keepLacks(const GroupGeometry& geometry, std::span<const Inner> inner,
                             std::span<const std::uint8_t> seen, std::span<const float> lacks) {
  constexpr std::size_t kSize = 2 * kLackValues;
  for (std::size_t first = 0, last = 0; first < inner.size(); first = last) {
    const std::uint32_t t = inner[first].triangle;
    float counted = 0.0f;
    for (last = first; last < inner.size() && inner[last].triangle == t; ++last) counted += seen[last];
    const auto lack = std::span(triangle_lack_).subspan(t * kSize, kSize);
    std::fill(lack.begin(), lack.end(), 0.0f);
    triangle_area_[t] = 0.0;
    if (counted == 0.0f) continue;
    triangle_area_[t] = triangleArea(geometry, geometry.triangles[t]);
    for (std::size_t i = first; i < last; ++i)
      for (std::size_t k = 0; k < kSize; ++k) lack[k] += lacks[i * kSize + k] / counted;
  }
}

void GroupRefiner::addLacks(const DrawGeometry& draw, FaceLacks& lacks) const {
  const std::size_t size = 2 * kLackValues;
  const auto from = std::span(triangle_lack_).subspan(draw.first_triangle * size, draw.triangle_count * size);
  const auto areas = std::span(triangle_area_).subspan(draw.first_triangle, draw.triangle_count);
  lacks.values.insert(lacks.values.end(), from.begin(), from.end());
  lacks.areas.insert(lacks.areas.end(), areas.begin(), areas.end());
}

Result<std::size_t> GroupRefiner::markWorst(std::size_t group, const GroupGeometry& geometry, double bound,
                                            std::size_t& room, MarkedEdges& edges) {
  const double allowed = bound * bound * seenArea(), square_error = squareError();
  if (square_error <= allowed) return 0;
  chosen_ = true;
  std::vector<std::uint32_t> order = allOf(geometry.triangles.size());
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return measured_[a].square_error > measured_[b].square_error;
  });
  const double enough = std::max(kLeftOfAllowed * allowed, kLeftOfAll * square_error);
  double left = square_error;
  std::vector<Edge> marked;
  for (const std::uint32_t t : order) {
    if (left <= enough || room < 3) break;
    const glm::uvec3 corners = geometry.triangles[t];
    const float longest = longestEdge(geometry, corners);
    left -= measured_[t].square_error;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t a = corners[c], b = corners[(c + 1) % 3];
      if (glm::distance(geometry.positions[a], geometry.positions[b]) < kSplitShare * longest) continue;
      const auto added = edges.mark(group, a, b);
      if (!added) continue;
      marked.push_back({a, b, t});
      room -= std::min(room, *added);
    }
  }
  // Longer edges are halved: light changes on both sides of a cut, too.
  const auto cuts = cutsOf(geometry, marked, kLongestCut * diagonal_);
  if (!cuts) return failAgain(cuts.error());
  for (std::size_t i = 0; i < marked.size(); ++i)
    if ((*cuts)[i] > 0.0f) edges.splitAt(group, marked[i].a, marked[i].b, (*cuts)[i]);
  return marked.size();
}

Result<std::optional<std::size_t>> GroupRefiner::markLeaks(std::size_t group, const GroupGeometry& geometry,
                                                           std::size_t& room, MarkedEdges& edges,
                                                           const BakeContext& context) {
  const SampleSet samples = buildSamples(geometry, /*with_texels=*/false);
  const std::vector<SampleKind> kinds = kindsOf(samples);
  const std::vector<std::uint32_t> looked_at = triangles(geometry);
  const std::vector<std::uint32_t> number = cornerPoints(few_, geometry, samples, kinds, looked_at);
  if (const auto probed = few_.probe(*scene_, context); !probed)
    return failAgain(probed.error());
  else if (!*probed)
    return std::nullopt;
  std::vector<float> light(samples.size(), 0.0f);
  std::vector<std::uint8_t> seen(samples.size(), 0);
  const auto lookAt = [&](std::size_t s) {
    if (number[s] == kUnused || !few_.seen(number[s])) return;
    seen[s] = 1;
    light[s] = few_.shadowProbe().openShare({few_.masksAt(number[s]), samples.normals[s]});
  };
  const bool done =
      parallelRanges(samples.size(), kPointsPerRange, context.stop, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) lookAt(s);
      });
  if (!done) return std::nullopt;
  lightUnseen(geometry, samples, looked_at, seen, light);
  std::vector<Edge> between;
  std::set<std::pair<std::uint32_t, std::uint32_t>> met;
  for (const std::uint32_t t : looked_at)
    for (int c = 0; c < 3; ++c) {
      std::uint32_t dark = geometry.triangles[t][c], lit = geometry.triangles[t][(c + 1) % 3];
      if (light[samples.vertex_sample[dark]] > light[samples.vertex_sample[lit]]) std::swap(dark, lit);
      const std::uint32_t in_dark = samples.vertex_sample[dark], in_light = samples.vertex_sample[lit];
      if (seen[in_dark] != 0 && light[in_light] > kLightShare &&
          light[in_dark] < kDarkShare * light[in_light] && met.emplace(std::minmax(dark, lit)).second)
        between.push_back({dark, lit, t});
    }
  const auto cuts = cutsOf(geometry, between, diagonal_);
  if (!cuts) return failAgain(cuts.error());
  std::size_t marked = 0;
  for (std::size_t i = 0; i < between.size() && room > 0; ++i) {
    if ((*cuts)[i] == 0.0f) continue;
    const auto added = edges.mark(group, between[i].a, between[i].b);
    if (!added) continue;
    edges.splitAt(group, between[i].a, between[i].b, (*cuts)[i]);
    ++marked, room -= std::min(room, *added);
  }
  return marked;
}

// A face that another surface cuts is lit on one side of it and dark on the other. No vertex may mix both,
// and none should stand in the cut: each side gets a vertex of its own, a little before it.
Result<std::vector<float>> GroupRefiner::cutsOf(const GroupGeometry& geometry, std::span<const Edge> list,
                                                float longest) {
  if (list.empty()) return {};
  const auto rays = scene_->rays();
  if (!rays) return failAgain(rays.error());
  std::vector<RaySegment> ways;
  for (const Edge& edge : list) {
    const glm::vec3 a = geometry.positions[edge.a], b = geometry.positions[edge.b];
    const auto area = static_cast<float>(triangleArea(geometry, geometry.triangles[edge.triangle]));
    const glm::vec3 off = standOff(a, std::sqrt(area)) * unitNormal(geometry, edge.triangle),
                    along = glm::normalize(b - a);
    ways.push_back({a + off, along, glm::distance(a, b)});
    ways.push_back({b + off, -along, glm::distance(a, b)});
  }
  std::vector<FirstHit> hits(ways.size());
  (*rays)->firstHits(ways, hits);
  const float before = kBeforeCut * diagonal_;
  // Returns the share of a way that lies before the surface that cuts it, less what its vertex keeps away, or
  // 0 if none does: surfaces that touch an end, as walls do the rim of a floor, cut nothing.
  const auto shareBefore = [&](std::size_t way) {
    const auto& [triangle, u, v, distance, back] = hits[way];
    if (!hits[way].any() || ways[way].length > longest) return 0.0f;
    const float steep = std::abs(glm::dot(scene_normals_[triangle], ways[way].direction));
    const bool cuts =
        distance * steep > kLeastCut * before && (ways[way].length - distance) * steep > 0.5f * before;
    return cuts ? (distance - before / steep) / ways[way].length : 0.0f;
  };
  std::vector<float> cuts(list.size(), 0.0f);
  for (std::size_t i = 0; i < list.size(); ++i) {
    cuts[i] = shareBefore(2 * i);
    if (const float other = shareBefore(2 * i + 1); cuts[i] == 0.0f && other > 0.0f) cuts[i] = 1.0f - other;
  }
  return cuts;
}

}  // namespace lambent::baker
