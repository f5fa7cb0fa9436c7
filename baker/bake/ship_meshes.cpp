#include "baker/bake/ship_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "baker/bake/lattice_steps.hpp"
#include "baker/bake/result_bytes.hpp"
#include "baker/import/mesh_edits.hpp"
#include "baker/jobs/kept_value.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kMaxTriangles = 4'000'000;  // per primitive after splitting

// Returns the longest edge of each mesh, in mesh units. A mesh that several draws use takes the shortest.
std::vector<float> longestEdges(const Scene& scene, const std::vector<RigidGroup>& groups, float max_edge_m) {
  std::vector<float> longest(scene.meshes.size(), std::numeric_limits<float>::infinity());
  if (!(max_edge_m > 0.0f)) return longest;
  for (const RigidGroup& group : groups)
    for (const PlannedDraw& draw : group.draws)
      if (const float scale = scaleOf(draw.group_from_mesh); scale > 0.0f)
        longest[draw.mesh] = std::min(longest[draw.mesh], max_edge_m / scale);
  return longest;
}

Result<EncodedMesh> encodeCached(const bundle::MeshData& mesh, float step, const std::string& subject,
                                 const BakeContext& context) {
  Key key;
  if (context.cache) {
    KeyMaker maker = KeyMaker::ofStage("draco");
    addMesh(mesh, maker);
    key = maker.add(step).key();
  }
  Result<EncodedMesh> encoded;
  findOrMake(context.keyed(key), *encoded, [&] {
    encoded = encodeDraco(mesh, step, subject);
    return encoded.has_value();
  });
  return encoded;
}

}  // namespace

Result<Meshes> splitMeshes(const Scene& scene, const std::vector<RigidGroup>& groups, float max_edge_m) {
  const std::vector<float> longest = longestEdges(scene, groups, max_edge_m);
  Meshes meshes(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (std::size_t p = 0; p < scene.meshes[m].primitives.size(); ++p) {
      bundle::MeshData mesh = scene.meshes[m].primitives[p].mesh;
      if (std::isfinite(longest[m]) && !splitLongEdges(mesh, longest[m], kMaxTriangles))
        return fail(
            fmt::format("{}: mesh {} primitive {}", scene.source.string(), m, p),
            fmt::format("would have more than {} triangles with --max-edge {}", kMaxTriangles, max_edge_m),
            "choose a longer edge");
      meshes[m].push_back(std::move(mesh));
    }
  return meshes;
}

Result<ShippedMeshes> shipMeshes(const Scene& scene, const std::vector<RigidGroup>& groups, Meshes meshes,
                                 const BakeContext& context) {
  const LatticeSteps steps = latticeSteps(scene, groups);
  closeSeams(groups, steps, meshes);
  struct Task {
    std::size_t mesh, primitive;
    std::optional<Result<EncodedMesh>> encoded;
  };
  std::vector<Task> tasks;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (std::size_t p = 0; p < scene.meshes[m].primitives.size(); ++p) tasks.push_back({m, p, std::nullopt});

  const auto encode = [&](std::size_t begin, std::size_t end) {
    for (Task& task : std::span(tasks).subspan(begin, end - begin)) {
      const std::string subject =
          fmt::format("{}: mesh {} primitive {}", scene.source.string(), task.mesh, task.primitive);
      task.encoded =
          encodeCached(meshes[task.mesh][task.primitive], steps[task.mesh][task.primitive], subject, context);
    }
  };
  // Each mesh is kept by itself, so the stage as a whole is not.
  if (!runStage({.name = "meshes", .unit = "meshes", .count = tasks.size(), .writes = {}, .compute = encode},
                context))
    return fail(scene.source.string(), "stopped", "");

  ShippedMeshes shipped;
  shipped.draco.resize(scene.meshes.size());
  shipped.attributes.resize(scene.meshes.size());
  shipped.decoded.resize(scene.meshes.size());
  for (Task& task : tasks) {
    if (!*task.encoded) return failAgain(task.encoded->error());
    EncodedMesh& encoded = **task.encoded;
    shipped.draco[task.mesh].push_back(std::move(encoded.bytes));
    shipped.attributes[task.mesh].push_back(encoded.attributes);
    shipped.decoded[task.mesh].push_back(std::move(encoded.decoded));
  }
  return shipped;
}

}  // namespace lambent::baker
