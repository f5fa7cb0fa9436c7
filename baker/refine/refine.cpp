#include "baker/refine/refine.hpp"

#include <algorithm>

#include "baker/refine/add_wedges.hpp"
#include "baker/refine/group_refiner.hpp"
#include "baker/refine/marked_edges.hpp"
#include "baker/refine/shadow_probe.hpp"
#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

namespace {

// Wedges are split until their error is this share of the bound: what splits of edges leave is mostly theirs,
// and they cost no triangles.
constexpr double kFanShare = 0.25;

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
  key.add(options.most_growth).add(std::uint64_t{options.most_added}).add(options.most_wedges);
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
  out.add(std::uint64_t{report.fans});
  out.add(report.error_before), out.add(report.error_after), out.add(report.rays + report.rays_kept);
  for (const auto& primitives : meshes)
    for (const bundle::MeshData& mesh : primitives) writeMesh(mesh, out);
}

bool readOutcome(ByteReader& in, RefineReport& report, std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::uint64_t before = 0, after = 0, fans = 0;
  in.read(before), in.read(after), in.read(fans), in.read(report.error_before), in.read(report.error_after);
  in.read(report.rays_kept);
  std::vector<std::vector<bundle::MeshData>> found;
  for (const auto& primitives : meshes) {
    found.emplace_back(primitives.size());
    for (bundle::MeshData& mesh : found.back())
      if (!readMesh(in, mesh)) return false;
  }
  if (!in.atEnd()) return false;
  report.vertices_before = before, report.vertices_after = after, report.fans = fans;
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
  for (std::size_t g = 0; g < groups.size(); ++g) refiners.emplace_back(probe, options.most_wedges > 0.0);

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
  const std::size_t most_wedges =
      std::min(static_cast<std::size_t>(options.most_wedges * static_cast<double>(report.vertices_after)),
               options.most_vertices - std::min(options.most_vertices, report.vertices_after));
  if (most_wedges > 0) {
    const auto fans =
        addWedges(groups, geometries, refiners, kFanShare * double{options.bound}, most_wedges, meshes, stop);
    if (!fans) return fail(scene.source.string(), "stopped; nothing was written");
    report.fans = *fans;
  }
  report.vertices_after = countVertices(meshes);
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
