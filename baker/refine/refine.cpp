#include "baker/refine/refine.hpp"

#include <algorithm>

#include "baker/jobs/kept_value.hpp"
#include "baker/refine/add_wedges.hpp"
#include "baker/refine/group_refiner.hpp"
#include "baker/refine/marked_edges.hpp"
#include "baker/refine/shadow_probe.hpp"
#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

namespace {

// Fans are added until the error, here relative to the light of an open point, is this share of the bound:
// most of what remains after splitting edges can only be reduced by fans, and they cost no triangles.
constexpr double kFanShare = 0.24;

std::size_t countVertices(const std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::size_t count = 0;
  for (const auto& primitives : meshes)
    for (const bundle::MeshData& mesh : primitives) count += mesh.positions.size();
  return count;
}

// Returns the key of the outcome: of all of the meshes, since splits carry all that they have along.
Key outcomeKey(const RefineScene& from, const std::vector<GroupGeometry>& geometries,
               const RefineOptions& options, const std::vector<std::vector<bundle::MeshData>>& meshes) {
  const auto& groups = from.groups;
  KeyMaker key = KeyMaker::ofStage("refinement");
  key.add(from.with_glossy).add(options.bound).add(std::uint64_t{options.rays});
  key.add(std::uint64_t{options.many_rays}).add(options.rounds);
  key.add(options.most_growth).add(std::uint64_t{options.most_added}).add(options.most_wedges);
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
  }
  return key.key();
}

struct Outcome {
  RefineReport& report;
  std::vector<std::vector<bundle::MeshData>>& meshes;
};

void write(const Outcome& outcome, ByteWriter& out) {
  const RefineReport& report = outcome.report;
  out.add(std::uint64_t{report.vertices_before}), out.add(std::uint64_t{report.vertices_after});
  out.add(std::uint64_t{report.fans});
  out.add(report.error_before), out.add(report.error_after), out.add(report.at_limit);
  out.add(report.rays + report.rays_kept);
  for (const auto& primitives : outcome.meshes)
    for (const bundle::MeshData& mesh : primitives) writeMesh(mesh, out);
}

// Changes nothing if the bytes are no such outcome.
bool read(ByteReader& in, Outcome& outcome) {
  RefineReport report;
  std::uint64_t before = 0, after = 0, fans = 0;
  in.read(before), in.read(after), in.read(fans), in.read(report.error_before), in.read(report.error_after);
  in.read(report.at_limit), in.read(report.rays_kept);
  std::vector<std::vector<bundle::MeshData>> found;
  for (const auto& primitives : outcome.meshes) {
    found.emplace_back(primitives.size());
    for (bundle::MeshData& mesh : found.back())
      if (!readMesh(in, mesh)) return false;
  }
  if (!in.atEnd()) return false;
  report.vertices_before = before, report.vertices_after = after, report.fans = fans;
  outcome.report = report;
  outcome.meshes = std::move(found);
  return true;
}

}  // namespace

Result<RefineReport> refineMeshes(const RefineScene& from, const RefineOptions& options,
                                  std::vector<std::vector<bundle::MeshData>>& meshes,
                                  const BakeContext& context) {
  context.progress.begin("refinement", 0, "probes");
  const auto& [scene, groups, transport, alpha_maps, with_glossy] = from;
  const auto stays = [&](std::size_t g) { return groups[g].draws.empty() || !transport[g].shadows; };
  std::vector<GroupGeometry> geometries;
  const auto build = [&] {
    geometries.clear();
    for (const RigidGroup& group : from.groups)
      geometries.push_back(buildGroupGeometry(group, from.scene, meshes, from.with_glossy));
  };
  build();
  const BakeContext outcome_context =
      context.keyed(context.cache ? outcomeKey(from, geometries, options, meshes) : Key{});
  RefineReport report;
  Outcome outcome{report, meshes};
  if (findKept(outcome_context, outcome)) return report;
  report.vertices_before = countVertices(meshes);
  const auto grown =
      static_cast<std::size_t>(options.most_growth * static_cast<double>(report.vertices_before)) +
      options.most_added;
  const std::size_t most = std::min(grown, options.most_vertices);
  if (report.vertices_before >= most) {  // probing is not worth its rays if nothing may be split
    report.vertices_after = report.vertices_before;
    report.at_limit = true;
    return report;
  }
  const ShadowProbe few(options.rays), many(options.many_rays);
  std::vector<GroupRefiner> refiners;
  for (std::size_t g = 0; g < groups.size(); ++g)
    refiners.emplace_back(RefineProbes{few, many}, options.most_wedges > 0.0);

  for (int round = 0;; ++round) {
    if (round > 0) build();
    report.error_after = 0.0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (stays(g)) continue;
      if (round == 0) refiners[g].prepare(geometries[g], scene, alpha_maps);
      const auto measured = refiners[g].measure(geometries[g], double{options.bound}, context);
      if (!measured) return failAgain(measured.error());
      if (!*measured) return fail(scene.source.string(), "stopped; nothing was written");
      report.error_after = std::max(report.error_after, refiners[g].relativeError());
    }
    if (round == 0) report.error_before = report.error_after;
    report.vertices_after = countVertices(meshes);
    report.at_limit = report.error_after > double{options.bound} &&
                      (round == options.rounds || report.vertices_after >= most);
    if (round == options.rounds || report.vertices_after >= most) break;
    MarkedEdges edges(groups, geometries, meshes);
    std::size_t room = most - report.vertices_after, marked = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (stays(g)) continue;
      const auto more = refiners[g].markWorst(g, geometries[g], double{options.bound}, room, edges);
      if (!more) return failAgain(more.error());
      marked += *more;
    }
    if (marked == 0) break;
    edges.split(meshes);
  }
  const std::size_t most_wedges =
      std::min(static_cast<std::size_t>(options.most_wedges * static_cast<double>(report.vertices_after)),
               options.most_vertices - std::min(options.most_vertices, report.vertices_after));
  if (most_wedges > 0) {
    const auto fans = addWedges({groups, geometries, refiners},
                                {kFanShare * double{options.bound}, most_wedges}, meshes, context.stop);
    if (!fans) return fail(scene.source.string(), "stopped; nothing was written");
    report.fans = *fans;
  }
  report.vertices_after = countVertices(meshes);
  for (const GroupRefiner& refiner : refiners)
    report.rays += refiner.raysTraced(), report.rays_kept += refiner.raysKept();
  keepValue(outcome_context, outcome);
  return report;
}

}  // namespace lambent::baker
