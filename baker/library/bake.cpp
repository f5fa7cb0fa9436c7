#include "lambent/bake.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/matrix_inverse.hpp>

#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/gltf.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "runtime/library/convert.hpp"
#include "runtime/spec/light.hpp"

namespace lambent {

using library::failureOf;
using library::toGlm;

namespace {

bool finite(const Vec3& v) {
  return std::isfinite(v.x + v.y + v.z);
}
bool within(const Vec3& v, float least, float most) {
  return std::min({v.x, v.y, v.z}) >= least && std::max({v.x, v.y, v.z}) <= most;
}

// Returns what is wrong with a mesh; empty: nothing.
std::string problemOf(const BakeMesh& mesh) {
  if (mesh.indices.empty() || mesh.indices.size() % 3 != 0)
    return fmt::format("has {} indices, which are no triangles", mesh.indices.size());
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size())
    return fmt::format("has {} normals for {} positions", mesh.normals.size(), mesh.positions.size());
  for (const std::uint32_t index : mesh.indices)
    if (index >= mesh.positions.size())
      return fmt::format("has an index {} for {} positions", index, mesh.positions.size());
  if (!std::ranges::all_of(mesh.positions, finite)) return "has a position that is not finite";
  if (!finite(mesh.albedo) || !within(mesh.albedo, 0.0f, 1.0f)) return "has an albedo outside 0..1";
  if (!finite(mesh.emission) || !within(mesh.emission, 0.0f, spec::kMostRadiance))
    return "has an emission outside 0..1e15";
  if (!(mesh.metallic >= 0.0f && mesh.metallic <= 1.0f && mesh.roughness >= 0.0f && mesh.roughness <= 1.0f))
    return "has metallic or roughness outside 0..1";
  const glm::mat4 matrix = toGlm(mesh.world_from_mesh);
  const float determinant = glm::determinant(glm::mat3(matrix));
  if (!std::isfinite(determinant) || determinant == 0.0f || !finite({matrix[3].x, matrix[3].y, matrix[3].z}))
    return "has a matrix that is singular or not finite";
  return {};
}

}  // namespace

struct BakeScene::State {
  baker::Scene scene;
};

BakeScene::BakeScene() : state_(std::make_unique<State>()) {
  state_->scene.source = "scene in memory";
}
BakeScene::BakeScene(BakeScene&&) noexcept = default;
BakeScene& BakeScene::operator=(BakeScene&&) noexcept = default;
BakeScene::~BakeScene() = default;

Expected<BakeScene> BakeScene::open(const std::string& path) {
  Result<baker::Scene> scene = baker::importScene(path);
  if (!scene) return failureOf(scene.error());
  BakeScene result;
  result.state_->scene = std::move(*scene);
  return result;
}

Expected<void> BakeScene::add(const BakeMesh& mesh) {
  baker::Scene& scene = state_->scene;
  const std::string name = mesh.name.empty() ? fmt::format("mesh {}", scene.meshes.size()) : mesh.name;
  if (std::string problem = problemOf(mesh); !problem.empty()) return Failure{name, std::move(problem), {}};
  baker::ScenePrimitive primitive;
  primitive.material = static_cast<std::int32_t>(scene.materials.size());
  for (const Vec3& position : mesh.positions) primitive.mesh.positions.push_back(toGlm(position));
  for (const Vec3& normal : mesh.normals) primitive.mesh.normals.push_back(toGlm(normal));
  primitive.mesh.indices.assign(mesh.indices.begin(), mesh.indices.end());
  baker::cleanMesh(primitive.mesh, name, scene.warnings);
  if (primitive.mesh.indices.empty()) return Failure{name, "has no triangle with an area", {}};
  gltf::Node node;
  node.name = name;
  node.parent_from_node = toGlm(mesh.world_from_mesh);
  node.mesh = static_cast<std::int32_t>(scene.meshes.size());
  node.movable = mesh.movable;
  gltf::Material material;
  material.name = name;
  material.base_color = glm::vec4(toGlm(mesh.albedo), 1.0f);
  material.metallic = mesh.metallic;
  material.roughness = mesh.roughness;
  material.emissive = toGlm(mesh.emission);
  material.double_sided = mesh.double_sided;
  scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
  scene.nodes.push_back(std::move(node));
  scene.meshes.push_back({.name = name, .primitives = {std::move(primitive)}});
  scene.materials.push_back(std::move(material));
  return {};
}

std::vector<std::string> BakeScene::warnings() const {
  return state_->scene.warnings;
}

struct Baker::State {
  baker::BakeOptions options;
  std::optional<baker::Cache> cache;
};

Baker::Baker() : state_(std::make_unique<State>()) {}
Baker::Baker(Baker&&) noexcept = default;
Baker& Baker::operator=(Baker&&) noexcept = default;
Baker::~Baker() = default;

Expected<void> Baker::set(const std::string& name, const std::string& value) {
  if (const Result<void> done = baker::putOption(state_->options, name, value); !done)
    return failureOf(done.error());
  return {};
}

Expected<void> Baker::keepResultsIn(const std::string& folder) {
  Result<baker::Cache> cache = baker::Cache::open(folder);
  if (!cache) return failureOf(cache.error());
  state_->cache.emplace(std::move(*cache));
  return {};
}

Expected<BakeResult> Baker::run(const BakeScene& scene, const std::string& output, const Watcher& watcher) {
  const baker::Scene& baked = scene.state_->scene;
  if (baked.meshes.empty() && baked.volumes.empty()) return Failure{"scene", "is empty", "add a mesh"};
  baker::Progress progress;
  std::stop_source stop;
  const auto start = std::chrono::steady_clock::now();
  const Result<baker::BakeReport> report = [&] {
    std::jthread watching;
    if (watcher) {
      baker::PartSeconds expected;
      if (const auto plan = baker::planFor(baked, state_->options))
        expected = baker::guessBake(baked, *plan, state_->options).seconds;
      watching = baker::watchProgress(
          progress, baker::WholeProgress(std::move(expected)), std::chrono::milliseconds(100),
          [&](const baker::WholeProgress::Seen& seen) {
            if (!seen.stage.name.empty() && !watcher({.stage = seen.stage.name,
                                                      .unit = seen.stage.unit,
                                                      .done = seen.stage.done,
                                                      .fraction = seen.share,
                                                      .seconds_left = seen.seconds_left}))
              stop.request_stop();
          });
    }
    return baker::bake(baked, state_->options, output,
                       {progress, stop.get_token(), state_->cache ? &*state_->cache : nullptr});
  }();
  if (!report) return failureOf(report.error());
  return BakeResult{
      .rays = report->rays,
      .samples = report->samples,
      .file_bytes = report->file_bytes,
      .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
      .notices = report->notices};
}

}  // namespace lambent
