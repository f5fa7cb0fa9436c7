#include "baker/refine/refine.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <unordered_map>

#include <glm/geometric.hpp>

#include "baker/cache/kept_ranges.hpp"
#include "baker/refine/marked_edges.hpp"
#include "baker/refine/shadow_probe.hpp"
#include "baker/transport/face_points.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/sample_areas.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/vertex_key.hpp"
#include "baker/work/parallel.hpp"

namespace lambent::baker {

namespace {

// A triangle is probed at n² points, where its longest edge is n times this share of the group's diagonal.
constexpr float kProbeSpacing = 1.0f / 24.0f;
constexpr int kMostProbesAlong = 8;
constexpr std::size_t kPointsPerRange = 64;  // that are probed
// Nothing is split below this share of the diagonal.
constexpr float kShortestEdge = 1.0f / 1024.0f;
// Of a triangle that is split, edges of at least this share of its longest.
constexpr float kSplitShare = 0.6f;
// A round splits triangles until what is left over has this share of the square error that is allowed, but no
// more than this share of all of it: what the first splits show decides where the next ones go.
constexpr double kLeftOfAllowed = 0.6, kLeftOfAll = 0.5;

// A point inside a triangle, by the weights of its corners.
struct InnerPoint {
  glm::vec3 weights;
};

// Middles of n² equal parts of a triangle.
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

// One group through all rounds.
class GroupRefiner {
 public:
  explicit GroupRefiner(const ShadowProbe& probe) : probe_(probe) {}

  // alpha_maps outlive this. The geometry is that before any split: rays are traced against it in all rounds.
  void prepare(const GroupGeometry& geometry, const Scene& scene,
               const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps, Cache* cache) {
    diagonal_ = glm::distance(geometry.bounds_min, geometry.bounds_max);
    build_rays_ = [geometry, &scene, &alpha_maps] { return RayScene::build(geometry, scene, alpha_maps); };
    KeyMaker key = KeyMaker::ofStage("refinement probes");
    if (cache) {
      addShape(geometry, key);
      addOpacity(scene, geometry, key);
    }
    keep_ = {cache, key.add(std::uint64_t{probe_.rays()}).key()};
  }

  // Area times square error of every triangle. Errors: no memory for the hierarchy. False when stopped.
  Result<bool> measure(const GroupGeometry& geometry, Progress& progress, const std::stop_token& stop);

  double relativeError() const { return area_ > 0.0 ? std::sqrt(std::max(0.0, square_error_) / area_) : 0.0; }
  std::uint64_t raysTraced() const { return traced_; }
  std::uint64_t raysKept() const { return rays_kept_; }

  // Marks edges of the worst triangles, until the rest is within the bound or `room` new vertices are spent.
  // Returns how many edges were marked.
  std::size_t markWorst(std::size_t group, const GroupGeometry& geometry, double bound, std::size_t& room,
                        MarkedEdges& edges) const;

 private:
  struct Point {
    glm::vec3 normal{0.0f};
    SampleKind kind = SampleKind::Plain;
    std::vector<SampleOrigin> origins;
    std::uint32_t shadow = 0;  // place in masks_
  };
  std::uint32_t shadowAt(const glm::vec3& position, const glm::vec3& normal, SampleKind kind,
                         std::span<const SampleOrigin> origins, std::vector<Point>& missing);
  std::span<const std::uint16_t> masksAt(std::uint32_t shadow) const {
    return std::span(masks_).subspan(shadow * probe_.packets(), probe_.packets());
  }
  // Fills in masks_ at the missing points.
  Result<bool> probe(const std::vector<Point>& missing, Progress& progress, const std::stop_token& stop);

  const ShadowProbe& probe_;
  Keep keep_;  // of the geometry that rays are traced against
  std::function<Result<RayScene>()> build_rays_;
  std::optional<RayScene> rays_;  // once something was not found
  float diagonal_ = 0.0f;
  // Where shadows were probed: triangles come and go, surfaces stay where they are.
  std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash> known_;
  std::vector<std::uint16_t> masks_;  // ShadowProbe::packets() each
  std::vector<std::uint8_t> seen_;    // by anybody
  std::vector<double> triangle_error_;
  double square_error_ = 0.0, area_ = 0.0;
  std::uint64_t traced_ = 0, rays_kept_ = 0;
};

std::uint32_t GroupRefiner::shadowAt(const glm::vec3& position, const glm::vec3& normal, SampleKind kind,
                                     std::span<const SampleOrigin> origins, std::vector<Point>& missing) {
  const auto next = static_cast<std::uint32_t>(seen_.size() + missing.size());
  const auto [entry, is_new] = known_.try_emplace(vertexKey(position, normal, kind), next);
  if (is_new) missing.push_back({normal, kind, {origins.begin(), origins.end()}, next});
  return entry->second;
}

float longestEdge(const GroupGeometry& geometry, const glm::uvec3& t) {
  const glm::vec3 &a = geometry.positions[t.x], &b = geometry.positions[t.y], &c = geometry.positions[t.z];
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

Result<bool> GroupRefiner::probe(const std::vector<Point>& missing, Progress& progress,
                                 const std::stop_token& stop) {
  const std::size_t size = probe_.packets(), first = seen_.size();  // missing ones are in order
  seen_.resize(first + missing.size());
  masks_.resize(seen_.size() * size);
  const auto masksOf = [&](std::size_t begin, std::size_t end) {
    return std::span(masks_).subspan((first + begin) * size, (end - begin) * size);
  };
  Keep keep = keep_;
  if (keep.cache) {
    KeyMaker key;
    key.add(keep_.key);
    for (const Point& point : missing) key.add(point.normal).add(point.kind).addList(point.origins);
    keep.key = key.key();
  }
  const auto unpack = [&](std::size_t begin, std::size_t end, ByteReader& in) {
    return in.readInto(masksOf(begin, end)) &&
           in.readInto(std::span(seen_).subspan(first + begin, end - begin));
  };
  const std::uint64_t rays = missing.size() * probe_.rays();
  if (restoreRanges(keep, missing.size(), kPointsPerRange, unpack)) {
    progress.add(missing.size());
    rays_kept_ += rays;
    return true;
  }
  if (!rays_) {
    auto built = build_rays_();
    if (!built) return failAgain(built.error());
    rays_ = std::move(*built);
  }
  std::atomic<std::uint64_t> traced = 0;
  const KeptRanges kept =
      keptRanges(keep, missing.size(), kPointsPerRange, stop,
                 {.compute =
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                          const Point& point = missing[i];
                          seen_[point.shadow] =
                              probe_.look(*rays_, point.origins, point.normal, point.kind, masksOf(i, i + 1));
                        }
                        traced += (end - begin) * probe_.rays();
                        progress.add(end - begin);
                      },
                  .pack =
                      [&](std::size_t begin, std::size_t end, ByteWriter& out) {
                        out.addList(std::span<const std::uint16_t>(masksOf(begin, end)));
                        out.addList(std::span<const std::uint8_t>(seen_).subspan(first + begin, end - begin));
                      },
                  .unpack = unpack});
  traced_ += traced;
  rays_kept_ += rays - traced;
  return kept.finished;
}

Result<bool> GroupRefiner::measure(const GroupGeometry& geometry, Progress& progress,
                                   const std::stop_token& stop) {
  const SampleSet samples = buildSamples(geometry);
  std::vector<Point> missing;
  std::vector<std::uint32_t> of_sample(samples.size());
  std::vector<SampleKind> kinds(samples.size());
  for (const SampleCell& cell : samples.cells) std::fill_n(kinds.begin() + cell.first, cell.count, cell.kind);
  for (std::size_t s = 0; s < samples.size(); ++s)
    of_sample[s] =
        shadowAt(samples.positions[s], samples.normals[s], kinds[s], samples.originsOf(s), missing);

  struct Inner {
    std::uint32_t triangle = 0, shadow = 0;
    glm::vec3 weights{0.0f}, normal{0.0f};
    SampleKind kind = SampleKind::Plain;
  };
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

  if (auto probed = probe(missing, progress, stop); !probed || !*probed) return probed;

  std::vector<double> error_at(inner.size());
  // What nobody sees has no error; what nobody sees from takes the place of its neighbours (fill.hpp).
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
    return probe_.squareError(corners, {masksAt(point.shadow), point.normal}, point.kind);
  };
  const bool measured =
      parallelRanges(inner.size(), kPointsPerRange, stop, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) error_at[i] = measureAt(i);
      });
  if (!measured) return false;

  triangle_error_.assign(geometry.triangles.size(), 0.0);
  square_error_ = area_ = 0.0;
  for (std::size_t first = 0; first < inner.size();) {
    const std::uint32_t t = inner[first].triangle;
    std::size_t last = first;
    double sum = 0.0;
    for (; last < inner.size() && inner[last].triangle == t; ++last) sum += error_at[last];
    const glm::uvec3 corners = geometry.triangles[t];
    const double area = triangleArea(geometry, corners);
    triangle_error_[t] = area * sum / static_cast<double>(last - first);
    square_error_ += triangle_error_[t];
    area_ += area;
    first = last;
  }
  return true;
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
    left -= triangle_error_[t];
    const glm::uvec3 corners = geometry.triangles[t];
    const float longest = longestEdge(geometry, corners);
    if (longest < kShortestEdge * diagonal_) continue;
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

std::size_t countVertices(const std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::size_t count = 0;
  for (const auto& primitives : meshes)
    for (const bundle::MeshData& mesh : primitives) count += mesh.positions.size();
  return count;
}

// What the outcome depends on: all of the meshes, since splits carry all that they have along.
Key outcomeKey(const Scene& scene, const std::vector<RigidGroup>& groups,
               const std::vector<GroupGeometry>& geometries, bool with_glossy, const RefineOptions& options,
               const std::vector<std::vector<bundle::MeshData>>& meshes) {
  KeyMaker key = KeyMaker::ofStage("refinement");
  key.add(with_glossy).add(options.bound).add(std::uint64_t{options.rays}).add(options.rounds);
  key.add(options.most_growth).add(std::uint64_t{options.most_added});
  key.add(std::uint64_t{options.most_vertices}).add(std::uint64_t{meshes.size()});
  for (const auto& primitives : meshes) {
    key.add(std::uint64_t{primitives.size()});
    for (const bundle::MeshData& mesh : primitives) addMesh(mesh, key);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    key.add(std::uint64_t{groups[g].draws.size()});
    for (const PlannedDraw& draw : groups[g].draws)
      key.add(draw.mesh).add(draw.primitive).add(draw.back).add(draw.group_from_mesh);
    addShape(geometries[g], key);
    addOpacity(scene, geometries[g], key);
  }
  return key.key();
}

void writeOutcome(const RefineReport& report, const std::vector<std::vector<bundle::MeshData>>& meshes,
                  ByteWriter& out) {
  out.add(std::uint64_t{report.vertices_before}), out.add(std::uint64_t{report.vertices_after});
  out.add(report.error_before), out.add(report.error_after), out.add(report.rays + report.rays_kept);
  for (const auto& primitives : meshes)
    for (const bundle::MeshData& mesh : primitives) writeMesh(mesh, out);
}

bool readOutcome(ByteReader& in, RefineReport& report, std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::uint64_t before = 0, after = 0;
  in.read(before), in.read(after), in.read(report.error_before), in.read(report.error_after);
  in.read(report.rays_kept);
  std::vector<std::vector<bundle::MeshData>> found;
  for (const auto& primitives : meshes) {
    found.emplace_back(primitives.size());
    for (bundle::MeshData& mesh : found.back())
      if (!readMesh(in, mesh)) return false;
  }
  if (!in.atEnd()) return false;
  report.vertices_before = before, report.vertices_after = after;
  meshes = std::move(found);
  return true;
}

}  // namespace

Result<RefineReport> refineMeshes(const Scene& scene, const std::vector<RigidGroup>& groups,
                                  const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps,
                                  bool with_glossy, const RefineOptions& options,
                                  std::vector<std::vector<bundle::MeshData>>& meshes, Progress& progress,
                                  const std::stop_token& stop, Cache* cache) {
  progress.begin("refinement", 0, "probes");
  std::vector<GroupGeometry> geometries;
  const auto build = [&] {
    geometries.clear();
    for (const RigidGroup& group : groups)
      geometries.push_back(buildGroupGeometry(group, scene, meshes, with_glossy));
  };
  build();
  Keep outcome{cache, {}};
  if (cache) {
    outcome.key = outcomeKey(scene, groups, geometries, with_glossy, options, meshes);
    if (const auto bytes = cache->find(outcome.key)) {
      ByteReader in(*bytes);
      if (RefineReport found; readOutcome(in, found, meshes)) return found;
    }
  }
  RefineReport report;
  report.vertices_before = countVertices(meshes);
  const auto grown =
      static_cast<std::size_t>(options.most_growth * static_cast<double>(report.vertices_before)) +
      options.most_added;
  const std::size_t most = std::min(grown, options.most_vertices);
  if (report.vertices_before >= most) {  // no look is worth its rays where nothing may be split
    report.vertices_after = report.vertices_before;
    return report;
  }
  const ShadowProbe probe(options.rays);
  std::vector<GroupRefiner> refiners;
  for (std::size_t g = 0; g < groups.size(); ++g) refiners.emplace_back(probe);

  for (int round = 0;; ++round) {
    if (round > 0) build();
    report.error_after = 0.0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (groups[g].draws.empty()) continue;
      if (round == 0) refiners[g].prepare(geometries[g], scene, alpha_maps, cache);
      const auto measured = refiners[g].measure(geometries[g], progress, stop);
      if (!measured) return failAgain(measured.error());
      if (!*measured) return fail(scene.source.string(), "stopped; nothing was written");
      report.error_after = std::max(report.error_after, refiners[g].relativeError());
    }
    if (round == 0) report.error_before = report.error_after;
    report.vertices_after = countVertices(meshes);
    if (round == options.rounds || report.vertices_after >= most) break;
    MarkedEdges edges(groups, geometries, meshes);
    std::size_t room = most - report.vertices_after, marked = 0;
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (!groups[g].draws.empty())
        marked += refiners[g].markWorst(g, geometries[g], double{options.bound}, room, edges);
    if (marked == 0) break;
    edges.split(meshes);
  }
  for (const GroupRefiner& refiner : refiners)
    report.rays += refiner.raysTraced(), report.rays_kept += refiner.raysKept();
  if (cache) {
    ByteWriter out;
    writeOutcome(report, meshes, out);
    cache->put(outcome.key, out.bytes());
  }
  return report;
}

}  // namespace lambent::baker
