#include "baker/refine/group_refiner.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/transport/face_points.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/sample_areas.hpp"

namespace lambent::baker {

namespace {

// A triangle is probed at n² points if its longest edge is n times this share of the group's diagonal.
constexpr float kProbeSpacing = 1.0f / 32.0f;
constexpr int kMostProbesAlong = 8;
constexpr std::size_t kPointsPerRange = 64;  // probed points in one range of work
// No edge is split if its triangle's longest edge is below this share of the diagonal.
constexpr float kShortestEdge = 1.0f / 1024.0f;
// Light is never taken to be less than this share of that of an open point: what bounces brightens the dark.
constexpr double kLeastLight = 0.07;
// A split triangle splits its edges of at least this share of the longest one.
constexpr float kSplitShare = 0.6f;
// A round splits triangles until the remaining square error is this share of what is allowed, or this share
// of all of it if that is more, because what the first splits show decides where the next ones go.
constexpr double kLeftOfAllowed = 0.6, kLeftOfAll = 0.35;

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

}  // namespace

void GroupRefiner::prepare(const GroupGeometry& geometry, const Scene& scene, const AlphaMaps& alpha_maps) {
  diagonal_ = glm::distance(geometry.bounds_min, geometry.bounds_max);
  build_rays_ = [geometry, &scene, &alpha_maps] { return RayScene::build(geometry, scene, alpha_maps); };
  KeyMaker key = KeyMaker::ofStage("refinement probes");
  addShape(geometry, key);
  addOpacity(scene, geometry, key);
  key_ = key.add(std::uint64_t{probe_.rays()}).key();
}

std::uint32_t GroupRefiner::shadowAt(const glm::vec3& position, const glm::vec3& normal, SampleKind kind,
                                     std::span<const SampleOrigin> origins, std::vector<Point>& missing) {
  const auto next = static_cast<std::uint32_t>(seen_.size() + missing.size());
  // A vertex looks from a little inside the faces around it. Once these are split it looks from elsewhere,
  // and is another point.
  std::uint32_t from = 0;
  for (const SampleOrigin& origin : origins)
    for (int k = 0; k < 3; ++k) from = from * 0x9E3779B1u + std::bit_cast<std::uint32_t>(origin.position[k]);
  VertexKey key = vertexKey(position, normal, kind);
  key.back() = from;
  const auto [entry, is_new] = known_.try_emplace(key, next);
  if (is_new) missing.push_back({normal, kind, {origins.begin(), origins.end()}, next});
  return entry->second;
}

Result<bool> GroupRefiner::probe(const std::vector<Point>& missing, const BakeContext& context) {
  const std::size_t size = probe_.packets(), first = seen_.size();  // missing ones are in order
  seen_.resize(first + missing.size());
  masks_.resize(seen_.size() * size);
  const auto masks = std::span(masks_).subspan(first * size);
  const auto compute = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Point& point = missing[i];
      seen_[point.shadow] =
          probe_.look(*rays_, point.origins, point.normal, point.kind, masks.subspan(i * size, size));
    }
  };
  const Stage stage{.count = missing.size(),
                    .grain = kPointsPerRange,
                    .writes = {rowsOf(masks, size), rowsOf(seen_, 1, static_cast<std::ptrdiff_t>(first))},
                    .compute = compute,
                    .keep = KeepWhen::Always};
  KeyMaker key;
  key.add(key_);
  for (const Point& point : missing) key.add(point.normal).add(point.kind).addList(point.origins);
  const BakeContext own = context.keyed(key.key());
  if (restoreStage(stage, own)) {
    rays_kept_ += missing.size() * probe_.rays();
    return true;
  }
  if (!rays_) {
    auto built = build_rays_();
    if (!built) return failAgain(built.error());
    rays_ = std::move(*built);
  }
  const auto done = runStage(stage, own);
  if (!done) return false;
  traced_ += done->computed * probe_.rays();
  rays_kept_ += done->found * probe_.rays();
  return true;
}

Result<bool> GroupRefiner::measure(const GroupGeometry& geometry, const BakeContext& context) {
  const SampleSet samples = buildSamples(geometry);
  std::vector<Point> missing;
  std::vector<std::uint32_t> of_sample(samples.size());
  std::vector<SampleKind> kinds(samples.size());
  for (const SampleCell& cell : samples.cells) std::fill_n(kinds.begin() + cell.first, cell.count, cell.kind);
  for (std::size_t s = 0; s < samples.size(); ++s)
    of_sample[s] =
        shadowAt(samples.positions[s], samples.normals[s], kinds[s], samples.originsOf(s), missing);

  std::vector<Inner> inner;
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
    const glm::uvec3 corners = geometry.triangles[t];
    const SampleKind kind = kinds[samples.vertex_sample[corners.x]];
    const int along =
        std::clamp(static_cast<int>(std::ceil(longestEdge(geometry, corners) / (kProbeSpacing * diagonal_))),
                   1, kMostProbesAlong);
    for (const InnerPoint& point : innerPoints(along)) {
      const FacePoint at = facePoint(geometry, corners, point.weights);
      inner.push_back({t, shadowAt(at.position, at.normal, kind, std::span(&at.origin, 1), missing),
                       point.weights, at.normal, kind});
    }
  }

  if (auto probed = probe(missing, context); !probed || !*probed) return probed;

  std::vector<double> error_at(inner.size());
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
                          shadow = of_sample[sample];
      HiddenFrom& corner = corners[static_cast<std::size_t>(c)];
      corner = {masksAt(shadow), samples.normals[sample], seen_[shadow] != 0 ? point.weights[c] : 0.0f};
      shares += corner.share;
    }
    if (seen_[point.shadow] == 0 || !(shares > 0.0f)) return 0.0;
    for (HiddenFrom& corner : corners) corner.share /= shares;
    const auto wrong = probe_.difference(corners, {masksAt(point.shadow), point.normal}, point.kind);
    const double light =
        ShadowProbe::squareError(probe_.arriving({masksAt(point.shadow), point.normal}, point.kind));
    seen_at[i] = 1;
    if (for_wedges_)
      for (std::size_t half = 0; half < 2; ++half)
        std::copy_n(wrong[half].begin(), kLackValues, lack_at.begin() + (2 * i + half) * kLackValues);
    return ShadowProbe::squareError(wrong) / (std::max(light, 0.0) + kLeastLight * kLeastLight);
  };
  const bool measured =
      parallelRanges(inner.size(), kPointsPerRange, context.stop, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) error_at[i] = measureAt(i);
      });
  if (!measured) return false;

  triangle_error_.assign(geometry.triangles.size(), 0.0);
  square_error_ = area_ = 0.0;
  for (std::size_t first = 0; first < inner.size();) {
    const std::uint32_t t = inner[first].triangle;
    std::size_t last = first;
    double sum = 0.0;
    std::size_t seen = 0;
    for (; last < inner.size() && inner[last].triangle == t; ++last)
      sum += error_at[last], seen += seen_at[last];
    const glm::uvec3 corners = geometry.triangles[t];
    const double area = triangleArea(geometry, corners);
    triangle_error_[t] = area * sum / static_cast<double>(last - first);
    square_error_ += triangle_error_[t];
    area_ += area * static_cast<double>(seen) / static_cast<double>(last - first);
    first = last;
  }
  if (for_wedges_) keepLacks(geometry, inner, seen_at, lack_at);
  return true;
}

// Keeps the mean over the points of each triangle that can be seen.
void GroupRefiner::keepLacks(const GroupGeometry& geometry, std::span<const Inner> inner,
                             std::span<const std::uint8_t> seen, std::span<const float> lacks) {
  constexpr std::size_t kSize = 2 * kLackValues;
  triangle_area_.assign(geometry.triangles.size(), 0.0);
  triangle_lack_.assign(geometry.triangles.size() * kSize, 0.0f);
  for (std::size_t first = 0, last = 0; first < inner.size(); first = last) {
    const std::uint32_t t = inner[first].triangle;
    float counted = 0.0f;
    for (last = first; last < inner.size() && inner[last].triangle == t; ++last) counted += seen[last];
    if (counted == 0.0f) continue;
    triangle_area_[t] = triangleArea(geometry, geometry.triangles[t]);
    for (std::size_t i = first; i < last; ++i)
      for (std::size_t k = 0; k < kSize; ++k) triangle_lack_[t * kSize + k] += lacks[i * kSize + k] / counted;
  }
}

void GroupRefiner::addLacks(const DrawGeometry& draw, FaceLacks& lacks) const {
  const std::size_t size = 2 * kLackValues;
  const auto from = std::span(triangle_lack_).subspan(draw.first_triangle * size, draw.triangle_count * size);
  const auto areas = std::span(triangle_area_).subspan(draw.first_triangle, draw.triangle_count);
  lacks.values.insert(lacks.values.end(), from.begin(), from.end());
  lacks.areas.insert(lacks.areas.end(), areas.begin(), areas.end());
}

std::size_t GroupRefiner::markWorst(std::size_t group, const GroupGeometry& geometry, double bound,
                                    std::size_t& room, MarkedEdges& edges) const {
  const double allowed = bound * bound * area_;
  if (square_error_ <= allowed) return 0;
  std::vector<std::uint32_t> order(geometry.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return triangle_error_[a] > triangle_error_[b]; });
  const double enough = std::max(kLeftOfAllowed * allowed, kLeftOfAll * square_error_);
  double left = square_error_;
  std::size_t marked = 0;
  for (const std::uint32_t t : order) {
    if (left <= enough || room < 3) break;
    const glm::uvec3 corners = geometry.triangles[t];
    const float longest = longestEdge(geometry, corners);
    if (longest < kShortestEdge * diagonal_) continue;
    left -= triangle_error_[t];
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t a = corners[c], b = corners[(c + 1) % 3];
      if (glm::distance(geometry.positions[a], geometry.positions[b]) < kSplitShare * longest) continue;
      if (!edges.mark(group, a, b)) continue;
      ++marked;
      --room;
    }
  }
  return marked;
}

}  // namespace lambent::baker
