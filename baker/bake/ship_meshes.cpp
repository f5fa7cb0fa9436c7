#include "baker/bake/ship_meshes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "baker/compress/draco_encode.hpp"
#include "baker/import/details.hpp"
#include "baker/import/mesh_edits.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/plan/local_light.hpp"
#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

template <>
inline constexpr auto kKeptMembers<EncodedMesh> = std::tuple(&EncodedMesh::bytes, &EncodedMesh::attributes,
                                                             &EncodedMesh::decoded);

namespace {

// Lattice bits along the group's longest axis: in a picture of 1000 pixels a vertex moves by less than a
// hundredth of a pixel.
constexpr int kLatticeBits = 18;

float longestSide(const Box& box) {
  const glm::vec3 size = box.high - box.low;
  return std::max({size.x, size.y, size.z, 0.0f});
}

float farthestFromOrigin(const Box& box) {
  const glm::vec3 far = glm::max(glm::abs(box.low), glm::abs(box.high));
  return std::max({far.x, far.y, far.z});
}

void grow(const bundle::MeshData& mesh, const glm::mat4& transform, Box& box) {
  for (const glm::vec3& p : mesh.positions) box.add(glm::vec3(transform * glm::vec4(p, 1.0f)));
}

float stepFor(float size, int bits) {
  return latticeStep(std::max(size, std::numeric_limits<float>::min()), bits);
}

// Returns the step of each mesh, in mesh units. A mesh that several draws use takes the finest.
std::vector<float> stepsOfGroups(const Scene& scene, const std::vector<RigidGroup>& groups) {
  std::vector<float> steps(scene.meshes.size(), std::numeric_limits<float>::max());
  for (const RigidGroup& group : groups) {
    Box box;
    for (const PlannedDraw& draw : group.draws)
      grow(scene.meshes[draw.mesh].primitives[draw.primitive].mesh, draw.group_from_mesh, box);
    const float longest = longestSide(box);
    if (!(longest > 0.0f)) continue;
    const float group_step = latticeStep(longest, kLatticeBits);
    for (const PlannedDraw& draw : group.draws) {
      const float scale = scaleOf(draw.group_from_mesh);
      // Steps are powers of two, so that meshes under the same scale get the very same lattice.
      if (scale > 0.0f)
        steps[draw.mesh] = std::min(steps[draw.mesh], std::exp2(std::floor(std::log2(group_step / scale))));
    }
  }
  return steps;
}

std::array<float, 3> keyOf(const glm::vec3& position) {
  return {position.x + 0.0f, position.y + 0.0f, position.z + 0.0f};  // -0 is 0
}

// Returns a power of two that changes edges of this length by less than a thousandth.
float stepThatKeeps(float detail) {
  return std::exp2(std::floor(std::log2(detail / 2048.0f)));
}

}  // namespace

float scaleOf(const glm::mat4& m) {
  return std::max({glm::length(glm::vec3(m[0])), glm::length(glm::vec3(m[1])), glm::length(glm::vec3(m[2]))});
}

LatticeSteps latticeSteps(const Scene& scene, const std::vector<RigidGroup>& groups) {
  const std::vector<float> of_group = stepsOfGroups(scene, groups);
  LatticeSteps steps(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const std::vector<ScenePrimitive>& primitives = scene.meshes[m].primitives;
    std::vector<Box> boxes(primitives.size());
    Box all;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      grow(primitives[p].mesh, glm::mat4(1.0f), boxes[p]);
      grow(primitives[p].mesh, glm::mat4(1.0f), all);
    }
    const bool drawn = of_group[m] != std::numeric_limits<float>::max();
    const float wanted = drawn ? of_group[m] : stepFor(longestSide(all), kLatticeBits);
    // Floats of a mesh far from its own origin cannot represent a lattice that fine.
    const float shared = std::max(wanted, stepFor(farthestFromOrigin(all), kMaxPositionBits - 1));
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const float finest =
          stepFor(std::max(farthestFromOrigin(boxes[p]), longestSide(boxes[p])), kMaxPositionBits - 1);
      const float detail = detailOf(primitives[p].mesh);
      steps[m].push_back(detail > 0.0f && bends(shared, detail)
                             ? std::max(std::min(shared, stepThatKeeps(detail)), finest)
                             : shared);
    }
  }
  return steps;
}

namespace {

// Moves vertices that a primitive shares with one on a coarser lattice to places on that, so that no seam
// opens between them.
void closeSeams(const std::vector<RigidGroup>& groups, const LatticeSteps& steps, Meshes& meshes) {
  using Primitive = std::pair<std::uint32_t, std::uint32_t>;  // mesh, primitive
  for (const RigidGroup& group : groups) {
    std::map<std::array<float, 16>, std::vector<Primitive>> spaces;  // by group_from_mesh
    for (const PlannedDraw& draw : group.draws) {
      std::array<float, 16> space;
      std::copy_n(glm::value_ptr(draw.group_from_mesh), 16, space.begin());
      spaces[space].emplace_back(draw.mesh, draw.primitive);
    }
    for (const auto& [space, primitives] : spaces) {
      const auto stepOf = [&](const Primitive& at) { return steps[at.first][at.second]; };
      const auto [finest, coarsest] = std::ranges::minmax(primitives, {}, stepOf);
      if (stepOf(finest) == stepOf(coarsest)) continue;
      std::map<std::array<float, 3>, float> coarser;  // the step by which a place is rounded
      for (const Primitive& at : primitives)
        if (stepOf(at) > stepOf(finest))
          for (const glm::vec3& position : meshes[at.first][at.second].positions) {
            float& step = coarser[keyOf(position)];
            step = std::max(step, stepOf(at));
          }
      for (const Primitive& at : primitives)
        for (glm::vec3& position : meshes[at.first][at.second].positions)
          if (const auto found = coarser.find(keyOf(position));
              found != coarser.end() && found->second > stepOf(at))
            position =
                glm::vec3(glm::round(glm::dvec3(position) / double{found->second}) * double{found->second});
    }
  }
}

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
