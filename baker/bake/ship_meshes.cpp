#include "baker/bake/ship_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/bake/result_bytes.hpp"
#include "baker/import/subdivide.hpp"
#include "baker/jobs/kept_value.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

namespace {

// Lattice bits along the group's longest axis: in a picture of 1000 pixels a vertex moves by less than a
// hundredth of a pixel.
constexpr int kLatticeBits = 18;
constexpr std::size_t kMaxTriangles = 4'000'000;  // per primitive after splitting

struct Box {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
  void add(glm::vec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
  float longest() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z, 0.0f}); }
  float furthest() const {
    const glm::vec3 far = glm::max(glm::abs(low), glm::abs(high));
    return std::max({far.x, far.y, far.z});
  }
};

Box boxOf(const SceneMesh& mesh, const glm::mat4& transform) {
  Box box;
  for (const ScenePrimitive& primitive : mesh.primitives)
    for (const glm::vec3& p : primitive.mesh.positions) box.add(glm::vec3(transform * glm::vec4(p, 1.0f)));
  return box;
}

// Returns the greatest length of a mesh's unit axes in the group's frame.
float scaleOf(const glm::mat4& m) {
  return std::max({glm::length(glm::vec3(m[0])), glm::length(glm::vec3(m[1])), glm::length(glm::vec3(m[2]))});
}

// Limits of one mesh, in mesh units. A mesh that several draws use takes the finest.
struct MeshLimits {
  float step = std::numeric_limits<float>::max();
  float max_edge = std::numeric_limits<float>::infinity();
};

std::vector<MeshLimits> limitsOf(const Scene& scene, const std::vector<RigidGroup>& groups,
                                 float max_edge_m) {
  std::vector<MeshLimits> limits(scene.meshes.size());
  for (const RigidGroup& group : groups) {
    Box box;
    for (const PlannedDraw& draw : group.draws) {
      const Box mesh = boxOf(scene.meshes[draw.mesh], draw.group_from_mesh);
      box.add(mesh.low), box.add(mesh.high);
    }
    const float longest = box.longest();
    if (!(longest > 0.0f)) continue;
    const float group_step = latticeStep(longest, kLatticeBits);
    for (const PlannedDraw& draw : group.draws) {
      const float scale = scaleOf(draw.group_from_mesh);
      if (!(scale > 0.0f)) continue;
      MeshLimits& mesh = limits[draw.mesh];
      // Steps are powers of two, so that meshes under the same scale get the very same lattice.
      mesh.step = std::min(mesh.step, std::exp2(std::floor(std::log2(group_step / scale))));
      if (max_edge_m > 0.0f) mesh.max_edge = std::min(mesh.max_edge, max_edge_m / scale);
    }
  }
  for (std::size_t m = 0; m < limits.size(); ++m) {
    const Box box = boxOf(scene.meshes[m], glm::mat4(1.0f));
    if (limits[m].step == std::numeric_limits<float>::max())  // drawn by no group
      limits[m].step = latticeStep(std::max(box.longest(), std::numeric_limits<float>::min()), kLatticeBits);
    // Floats of a mesh far from its own origin cannot represent a lattice that fine.
    const float finest =
        latticeStep(std::max(box.furthest(), std::numeric_limits<float>::min()), kMaxPositionBits - 1);
    limits[m].step = std::max(limits[m].step, finest);
  }
  return limits;
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
  const std::vector<MeshLimits> limits = limitsOf(scene, groups, max_edge_m);
  Meshes meshes(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (std::size_t p = 0; p < scene.meshes[m].primitives.size(); ++p) {
      bundle::MeshData mesh = scene.meshes[m].primitives[p].mesh;
      if (std::isfinite(limits[m].max_edge) && !splitLongEdges(mesh, limits[m].max_edge, kMaxTriangles))
        return fail(
            fmt::format("{}: mesh {} primitive {}", scene.source.string(), m, p),
            fmt::format("would have more than {} triangles with --max-edge {}", kMaxTriangles, max_edge_m),
            "choose a longer edge");
      meshes[m].push_back(std::move(mesh));
    }
  return meshes;
}

Result<ShippedMeshes> shipMeshes(const Scene& scene, const std::vector<RigidGroup>& groups,
                                 const Meshes& meshes, const BakeContext& context) {
  const std::vector<MeshLimits> limits = limitsOf(scene, groups, /*max_edge_m=*/0.0f);
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
          encodeCached(meshes[task.mesh][task.primitive], limits[task.mesh].step, subject, context);
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
