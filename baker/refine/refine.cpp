#include "baker/refine/refine.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/import/mesh_edits.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/refine/group_refiner.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Everything that the cache keeps of a refinement.
struct RefineOutcome {
  RefineReport report;
  std::vector<std::vector<bundle::MeshData>> meshes;
};

template <>
inline constexpr auto kKeptMembers<RefineReport> = std::tuple(
    &RefineReport::vertices_before, &RefineReport::vertices_after, &RefineReport::error_before,
    &RefineReport::error_after, &RefineReport::at_limit, &RefineReport::rays, &RefineReport::rays_kept);
template <>
inline constexpr auto kKeptMembers<RefineOutcome> = std::tuple(&RefineOutcome::report,
                                                               &RefineOutcome::meshes);

namespace {

// Before anything is measured, this many probes are expected of a vertex, splits included: the gallery, at
// draft quality, takes 3.6 for each vertex that it has in the end.
constexpr double kExpectedProbes = 7.0;
// The share of the square error that a round is expected to leave before any has shown it, and the least and
// most that it is taken to leave.
constexpr double kLeftByRound = 0.5, kLeastLeft = 0.1, kMostLeft = 0.9;

// Splits that leave so large an error with half of the vertices that they may add are taken back, and flat
// faces filled. Elsewhere splits reach the bound with fewer vertices.
constexpr double kHopeless = 0.25;

// Each round of cuts shows where the rest of an edge is cut, seen from its other end.
constexpr int kMostLeakRounds = 8;

std::size_t countVertices(const std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::size_t count = 0;
  for (const auto& primitives : meshes)
    for (const bundle::MeshData& mesh : primitives) count += mesh.positions.size();
  return count;
}

std::vector<GroupGeometry> geometriesOf(const RefineScene& from,
                                        const std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::vector<GroupGeometry> geometries;
  for (const RigidGroup& group : from.groups)
    geometries.push_back(buildGroupGeometry(group, from.scene, meshes, from.with_glossy));
  return geometries;
}

tl::unexpected<Error> stopped(const RefineScene& from) {
  return fail(from.scene.source.string(), "stopped; nothing was written");
}

// Returns the key of the outcome: of all of the meshes, since splits carry all that they have along.
Key outcomeKey(const RefineScene& from, const std::vector<GroupGeometry>& geometries,
               const RefineOptions& options, const std::vector<std::vector<bundle::MeshData>>& meshes) {
  const auto& groups = from.groups;
  KeyMaker key = KeyMaker::ofStage("refinement");
  key.add(from.with_glossy).add(options.bound).add(std::uint64_t{options.rays});
  key.add(std::uint64_t{options.many_rays}).add(options.rounds).add(options.glossy);
  key.add(options.most_growth).add(std::uint64_t{options.most_added});
  key.add(std::uint64_t{options.most_vertices}).add(std::uint64_t{meshes.size()});
  for (const auto& primitives : meshes) {
    key.add(std::uint64_t{primitives.size()});
    for (const bundle::MeshData& mesh : primitives) addMesh(mesh, key);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    key.add(std::uint64_t{groups[g].draws.size()}).add(from.transport[g].shadows);
    for (const PlannedDraw& draw : groups[g].draws)
      key.add(draw.mesh).add(draw.primitive).add(draw.back).add(draw.group_from_mesh);
    addShape(geometries[g], key);
    addOpacity(from.scene, geometries[g], key);
    addLights(from.scene, geometries[g], findGroupLights(from.scene, groups[g]), key);
    addEyes(cameraEyes(from.scene, groups[g], geometries[g]), key);
  }
  return key.key();
}

// Splits edges round after round: first those over which light leaks, since no number of other splits mends
// these, then those of the worst triangles, until the error is within the bound. Where that would take too
// many, large flat faces are filled with regular triangles first (flat_faces.hpp).
class Rounds {
 public:
  // Everything must outlive it.
  Rounds(const RefineScene& from, const RefineOptions& options, std::size_t most,
         std::vector<std::vector<bundle::MeshData>>& meshes, const BakeContext& context, RefineReport& report)
      : from_(from),
        options_(options),
        most_(most),
        copies_(copiesOf(from.groups, meshes)),
        meshes_(meshes),
        context_(context),
        report_(report),
        few_(options.rays),
        many_(options.many_rays) {}

  // `geometries` are those of the groups before any split. Errors: stopped; no memory for the hierarchy.
  Result<void> run(std::vector<GroupGeometry> geometries) {
    geometries_ = std::move(geometries);
    for (std::size_t g = 0; g < from_.groups.size(); ++g) {
      refiners_.emplace_back();
      if (from_.groups[g].draws.empty() || !from_.transport[g].shadows) continue;
      refiners_[g] = std::make_unique<GroupRefiner>(from_, geometries_[g], few_, many_, options_.glossy);
      if (auto prepared = refiners_[g]->prepare(from_.groups[g]); !prepared) return prepared;
    }
    if (auto measured = measure(); !measured) return measured;
    report_.error_before = report_.error_after;
    std::optional<std::vector<std::vector<bundle::MeshData>>> whole = meshes_;
    const auto fillIfHopeless = [&, half = room() / 2]() -> Result<void> {
      if (!whole || room() >= half || report_.error_after <= kHopeless) return {};
      meshes_ = *std::exchange(whole, std::nullopt);
      return fillFaces();
    };
    if (auto cut = cutLeaks(); !cut) return cut;
    if (auto filled = fillIfHopeless(); !filled) return filled;
    double left_by_round = kLeftByRound;
    std::uint64_t done_before = 0;
    for (int round = 0; round < options_.rounds && room() > 0; ++round) {
      const auto marked = split([&](std::size_t g, std::size_t& left, MarkedEdges& edges) {
        return refiners_[g]->markWorst(g, geometries_[g], double{options_.bound}, left, edges);
      });
      if (!marked) return failAgain(marked.error());
      if (*marked == 0) return cutLeaks();
      const std::uint64_t done = context_.progress.now().done;
      expectRounds(options_.rounds - round, left_by_round, done - done_before);
      done_before = done;
      const double error = report_.error_after;
      if (auto measured = measure(); !measured) return measured;
      const double ratio = error > 0.0 ? report_.error_after / error : 0.0;
      left_by_round = std::clamp(ratio * ratio, kLeastLeft, kMostLeft);
      if (auto filled = fillIfHopeless(); !filled) return filled;
    }
    report_.at_limit = report_.error_after > double{options_.bound};
    return {};
  }

  void addRays() {
    for (const auto& refiner : refiners_)
      if (refiner) report_.rays += refiner->raysTraced(), report_.rays_kept += refiner->raysKept();
  }

 private:
  std::size_t room() const { return most_ - std::min(most_, countDrawn(copies_, meshes_)); }

  // Tells the progress what the rounds up to the bound are expected to probe, each as much as the last one.
  void expectRounds(int most, double left_by_round, std::uint64_t of_a_round) const {
    const double bound = double{options_.bound}, ratio = bound > 0.0 ? report_.error_after / bound : 1e6;
    const double needed = std::ceil(std::log(std::max(1.0, ratio * ratio)) / -std::log(left_by_round));
    const double rounds = std::clamp(needed, 1.0, static_cast<double>(most));
    context_.progress.expect(context_.progress.now().done +
                             static_cast<std::uint64_t>(rounds * static_cast<double>(of_a_round)));
  }

  Result<void> measure() {
    report_.error_after = 0.0;
    for (std::size_t g = 0; g < refiners_.size(); ++g) {
      if (!refiners_[g]) continue;
      const auto measured = refiners_[g]->measure(geometries_[g], double{options_.bound}, context_);
      if (!measured) return failAgain(measured.error());
      if (!*measured) return stopped(from_);
      report_.error_after = std::max(report_.error_after, refiners_[g]->relativeError());
    }
    return {};
  }

  // Splits the edges that mark(group, room, edges) marks in each group, which returns nothing when stopped.
  // Returns how many these were.
  template <typename Mark>
  Result<std::size_t> split(const Mark& mark) {
    MarkedEdges edges(from_.groups, geometries_, meshes_);
    std::size_t left = room(), marked = 0;
    for (std::size_t g = 0; g < refiners_.size(); ++g) {
      if (!refiners_[g]) continue;
      const std::optional<std::size_t> more = mark(g, left, edges);
      if (!more) return stopped(from_);
      marked += *more;
    }
    if (marked == 0) return marked;
    edges.split(meshes_);
    geometries_ = geometriesOf(from_, meshes_);
    return marked;
  }

  // Fills flat faces of the meshes before any split.
  Result<void> fillFaces() {
    geometries_ = geometriesOf(from_, meshes_);
    if (auto measured = measure(); !measured) return measured;
    for (std::size_t g = 0; g < refiners_.size(); ++g)
      if (refiners_[g])
        refiners_[g]->fillFaces(from_.groups[g], geometries_[g], double{options_.bound}, copies_, room(),
                                meshes_);
    geometries_ = geometriesOf(from_, meshes_);
    if (auto measured = measure(); !measured) return measured;
    return cutLeaks();
  }

  Result<void> cutLeaks() {
    bool cut = false;
    for (int round = 0; round < kMostLeakRounds; ++round) {
      const auto marked = split([&](std::size_t g, std::size_t& left, MarkedEdges& edges) {
        return refiners_[g]->markLeaks(g, geometries_[g], left, edges, context_);
      });
      if (!marked) return failAgain(marked.error());
      if (*marked == 0) break;
      cut = true;
    }
    return cut ? measure() : Result<void>();
  }

  const RefineScene& from_;
  const RefineOptions& options_;
  std::size_t most_;  // vertices of all that is drawn
  CopiesOfMeshes copies_;
  std::vector<std::vector<bundle::MeshData>>& meshes_;
  const BakeContext& context_;
  RefineReport& report_;
  ShadowProbe few_, many_;
  std::vector<std::unique_ptr<GroupRefiner>> refiners_;  // null for groups that stay as they are
  std::vector<GroupGeometry> geometries_;
};

}  // namespace

Result<RefineReport> refineMeshes(const RefineScene& from, const RefineOptions& options,
                                  std::vector<std::vector<bundle::MeshData>>& meshes,
                                  const BakeContext& context) {
  const auto expected = static_cast<std::uint64_t>(
      kExpectedProbes * static_cast<double>(countDrawn(copiesOf(from.groups, meshes), meshes)));
  context.progress.begin("refinement", expected, "probes");
  std::vector<GroupGeometry> geometries = geometriesOf(from, meshes);
  const BakeContext outcome_context =
      context.keyed(context.cache ? outcomeKey(from, geometries, options, meshes) : Key{});
  RefineOutcome outcome;
  RefineReport& report = outcome.report;
  if (findKept(outcome_context, outcome)) {
    meshes = std::move(outcome.meshes);
    report.rays_kept += std::exchange(report.rays, 0);
    return report;
  }
  report = {};
  report.vertices_before = countVertices(meshes);
  const std::size_t drawn = countDrawn(copiesOf(from.groups, meshes), meshes);
  const auto grown =
      static_cast<std::size_t>(options.most_growth * static_cast<double>(drawn)) + options.most_added;
  const std::size_t most = std::min(grown, options.most_vertices);
  if (drawn >= most) {  // probing is not worth its rays if nothing may be split
    report.vertices_after = report.vertices_before;
    report.at_limit = true;
    return report;
  }
  Rounds rounds(from, options, most, meshes, context, report);
  if (auto refined = rounds.run(std::move(geometries)); !refined) return failAgain(refined.error());
  report.vertices_after = countVertices(meshes);
  rounds.addRays();
  if (outcome_context.keeps()) {
    outcome.meshes = meshes;
    keepValue(outcome_context, outcome);
  }
  return report;
}

CopiesOfMeshes copiesOf(const std::vector<RigidGroup>& groups,
                        const std::vector<std::vector<bundle::MeshData>>& meshes) {
  CopiesOfMeshes copies;
  for (const auto& primitives : meshes) copies.emplace_back(primitives.size(), 0);
  for (const RigidGroup& group : groups)
    for (const PlannedDraw& draw : group.draws)
      if (!draw.back) ++copies[draw.mesh][draw.primitive];
  for (auto& primitives : copies)
    for (std::size_t& count : primitives) count = std::max<std::size_t>(count, 1);
  return copies;
}

std::size_t countDrawn(const CopiesOfMeshes& copies,
                       const std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::size_t count = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t p = 0; p < meshes[m].size(); ++p) count += copies[m][p] * meshes[m][p].positions.size();
  return count;
}

namespace {

// An edge that begins nearer before a cut than this many times as far as its vertices is not cut again.
constexpr float kLeastCut = 2.0f;

// Returns a unit normal, or 0 for a triangle without area.
glm::vec3 unitNormal(const GroupGeometry& geometry, std::uint32_t triangle) {
  const glm::vec3 normal = areaNormal(geometry, geometry.triangles[triangle]);
  const float length = glm::length(normal);
  return length > 0.0f ? normal / length : glm::vec3(0.0f);
}

}  // namespace

std::vector<float> cutShares(const GroupGeometry& scene, const RayScene& rays, float extent,
                             const GroupGeometry& geometry, std::span<const FaceEdge> edges, float longest) {
  const float before = kBeforeCut * extent;  // the distance of a vertex from a cut
  std::vector<RaySegment> ways;
  for (const FaceEdge& edge : edges) {
    const glm::vec3 a = geometry.positions[edge.a], b = geometry.positions[edge.b];
    const auto area = static_cast<float>(triangleArea(geometry, geometry.triangles[edge.triangle]));
    const glm::vec3 off = standOff(a, std::sqrt(area)) * unitNormal(geometry, edge.triangle);
    const float length = glm::distance(a, b);  // 0 where two vertices of a face are in one place
    const glm::vec3 along = length > 0.0f ? (b - a) / length : glm::vec3(0.0f);
    ways.push_back({a + off, along, length});
    ways.push_back({b + off, -along, length});
  }
  std::vector<FirstHit> hits(ways.size());
  rays.firstHits(ways, hits);
  // Returns the share of a way that lies before the surface that cuts it, less what its vertex keeps away, or
  // 0 if none does: surfaces that touch an end, as walls do the rim of a floor, cut nothing.
  const auto shareBefore = [&](std::size_t way) {
    if (!hits[way].any() || ways[way].length > longest) return 0.0f;
    const float steep = std::abs(glm::dot(unitNormal(scene, hits[way].triangle), ways[way].direction));
    const float distance = hits[way].distance;
    const bool cuts =
        distance * steep > kLeastCut * before && (ways[way].length - distance) * steep > 0.5f * before;
    return cuts ? (distance - before / steep) / ways[way].length : 0.0f;
  };
  std::vector<float> shares(edges.size(), 0.0f);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    shares[i] = shareBefore(2 * i);
    if (const float other = shareBefore(2 * i + 1); shares[i] == 0.0f && other > 0.0f)
      shares[i] = 1.0f - other;
  }
  return shares;
}

std::vector<std::uint32_t> placesIn(const GroupGeometry& geometry) {
  std::vector<std::uint32_t> order(geometry.positions.size()), places(geometry.positions.size());
  for (std::uint32_t v = 0; v < order.size(); ++v) order[v] = v;
  const auto key = [&](std::uint32_t v) {
    const glm::vec3& p = geometry.positions[v];
    return std::array{p.x, p.y, p.z};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::uint32_t place = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i]) != key(order[i - 1])) ++place;
    places[order[i]] = place;
  }
  return places;
}

namespace {

// Shares of edges are multiples of its inverse, so that 1 - share has the same bits whichever end comes
// first.
constexpr float kShareSteps = 65536.0f;

// Calls visit(a, b) with the vertices at the ends of every edge of every triangle.
template <typename Visit>
void forEdges(const bundle::MeshData& mesh, const Visit& visit) {
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    for (std::size_t c = 0; c < 3; ++c) visit(mesh.indices[i + c], mesh.indices[i + (c + 1) % 3]);
}

}  // namespace

MarkedEdges::MarkedEdges(const std::vector<RigidGroup>& groups, const std::vector<GroupGeometry>& geometries,
                         const std::vector<std::vector<bundle::MeshData>>& meshes)
    : groups_(groups),
      geometries_(geometries),
      meshes_(meshes),
      in_group_(groups.size()),
      copies_(copiesOf(groups, meshes)) {
  for (const GroupGeometry& geometry : geometries) place_.push_back(placesIn(geometry));
  for (const auto& primitives : meshes)
    in_mesh_.emplace_back(primitives.size()), counted_.emplace_back(primitives.size());
}

// Counts an edge once in all copies of its mesh.
std::size_t MarkedEdges::added(std::size_t group, std::uint32_t a, std::uint32_t b) {
  const auto& draws = geometries_[group].draws;
  const auto after = std::ranges::upper_bound(draws, a, {}, &DrawGeometry::first_vertex);
  const auto index = static_cast<std::size_t>(after - draws.begin()) - 1;
  const PlannedDraw& draw = groups_[group].draws[index];
  const std::uint32_t first = draws[index].first_vertex;
  const bool counted = !counted_[draw.mesh][draw.primitive].insert(pairOf(a - first, b - first)).second;
  return counted ? 0 : copies_[draw.mesh][draw.primitive];
}

std::uint64_t MarkedEdges::placesOf(std::size_t group, std::uint32_t a, std::uint32_t b) const {
  return pairOf(place_[group][a], place_[group][b]);
}

std::optional<std::size_t> MarkedEdges::mark(std::size_t group, std::uint32_t a, std::uint32_t b) {
  if (!in_group_[group].try_emplace(placesOf(group, a, b), 0.5f).second) return std::nullopt;
  return added(group, a, b);
}

void MarkedEdges::splitAt(std::size_t group, std::uint32_t a, std::uint32_t b, float share) {
  const float rounded = std::round(share * kShareSteps) / kShareSteps;
  in_group_[group][placesOf(group, a, b)] = place_[group][a] < place_[group][b] ? rounded : 1.0f - rounded;
}

// Carries marks from groups to the meshes that are drawn there, and back. Returns false once nothing is new.
bool MarkedEdges::spread() {
  bool any = false;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    for (std::size_t d = 0; d < groups_[g].draws.size(); ++d) {
      const PlannedDraw& draw = groups_[g].draws[d];
      const std::uint32_t first = geometries_[g].draws[d].first_vertex;
      auto& marked = in_mesh_[draw.mesh][draw.primitive];
      if (in_group_[g].empty() && marked.empty()) continue;
      forEdges(meshes_[draw.mesh][draw.primitive], [&](std::uint32_t a, std::uint32_t b) {
        const bool turned = (place_[g][first + a] < place_[g][first + b]) != (a < b);
        const auto across = [&](float share) { return turned ? 1.0f - share : share; };
        const std::uint64_t places = placesOf(g, first + a, first + b), vertices = pairOf(a, b);
        if (const auto found = in_group_[g].find(places); found != in_group_[g].end())
          any |= marked.try_emplace(vertices, across(found->second)).second;
        else if (const auto own = marked.find(vertices); own != marked.end())
          any |= in_group_[g].try_emplace(places, across(own->second)).second;
      });
    }
  return any;
}

void MarkedEdges::split(std::vector<std::vector<bundle::MeshData>>& meshes) {
  while (spread()) {
  }
  for (std::size_t m = 0; m < in_mesh_.size(); ++m)
    for (std::size_t p = 0; p < in_mesh_[m].size(); ++p) {
      const auto& marked = in_mesh_[m][p];
      if (marked.empty()) continue;
      splitMarkedEdges(meshes[m][p], [&](std::uint32_t a, std::uint32_t b) {
        const auto found = marked.find(pairOf(a, b));
        return found == marked.end() ? 0.0f : a < b ? found->second : 1.0f - found->second;
      });
    }
}

}  // namespace lambent::baker
