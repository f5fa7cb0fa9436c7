#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/tinygltf.hpp"

namespace lambent::baker {
namespace {

glm::dmat4 localMatrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 matrix(1.0);
  if (node.translation.size() == 3) matrix = glm::translate(matrix, glm::make_vec3(node.translation.data()));
  if (node.rotation.size() == 4) {
    const auto& r = node.rotation;
    const glm::dquat rotation(r[3], r[0], r[1], r[2]);
    // A quaternion of length zero rotates nothing.
    if (glm::length(rotation) > 0.0) matrix *= glm::mat4_cast(glm::normalize(rotation));
  }
  if (node.scale.size() == 3) matrix = glm::scale(matrix, glm::make_vec3(node.scale.data()));
  return matrix;
}

bool isMovable(const tinygltf::Node& node) {
  if (!node.extras.IsObject() || !node.extras.Has("lambent")) return false;
  const tinygltf::Value& lambent = node.extras.Get("lambent");
  return lambent.IsObject() && lambent.Has("movable") && lambent.Get("movable").IsBool() &&
         lambent.Get("movable").Get<bool>();
}

std::int32_t lightOf(const nlohmann::json& node) {
  if (!node.contains("extensions") || !node["extensions"].contains("KHR_lights_punctual")) return -1;
  return node["extensions"]["KHR_lights_punctual"]["light"].get<std::int32_t>();
}

std::vector<int> parentless(const tinygltf::Model& model) {
  std::vector<bool> has_parent(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes)
    for (int child : node.children) has_parent[static_cast<std::size_t>(child)] = true;
  std::vector<int> found;
  for (std::size_t i = 0; i < has_parent.size(); ++i)
    if (!has_parent[i]) found.push_back(static_cast<int>(i));
  return found;
}

// Returns the roots of the default scene, or of the first one; in a file without scenes, all nodes without a
// parent.
std::vector<int> rootsOf(const tinygltf::Model& model) {
  if (model.scenes.empty()) return parentless(model);
  return model.scenes[static_cast<std::size_t>(std::max(model.defaultScene, 0))].nodes;
}

gltf::Camera convertCamera(const tinygltf::Camera& camera) {
  gltf::Camera out;
  out.name = camera.name;
  out.perspective = camera.type == "perspective";
  if (out.perspective) {
    out.yfov_rad = static_cast<float>(camera.perspective.yfov);
    out.aspect = static_cast<float>(camera.perspective.aspectRatio);
    out.znear = static_cast<float>(camera.perspective.znear);
    out.zfar = static_cast<float>(camera.perspective.zfar);
  } else {
    out.xmag = static_cast<float>(camera.orthographic.xmag);
    out.ymag = static_cast<float>(camera.orthographic.ymag);
    out.znear = static_cast<float>(camera.orthographic.znear);
    out.zfar = static_cast<float>(camera.orthographic.zfar);
  }
  return out;
}

}  // namespace

glm::dmat4 localMatrix(const Document& document, std::size_t file_node) {
  return localMatrix(document.model().nodes[file_node]);
}

std::vector<glm::dmat4> fileWorldTransforms(const Document& document) {
  const auto& sources = document.model().nodes;
  std::vector<glm::dmat4> world(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) world[i] = localMatrix(sources[i]);
  std::vector<int> open = parentless(document.model());  // nodes whose matrices are those of the world
  while (!open.empty()) {
    const auto parent = static_cast<std::size_t>(open.back());
    open.pop_back();
    for (const int child : sources[parent].children) {
      world[static_cast<std::size_t>(child)] = world[parent] * world[static_cast<std::size_t>(child)];
      open.push_back(child);
    }
  }
  return world;
}

std::vector<glm::dmat4> sceneWorldTransforms(const NodeMap& map, const Scene& scene) {
  std::vector<glm::dmat4> world = map.parent_from_node;
  for (std::size_t n = 0; n < world.size(); ++n)  // parents come first
    if (const std::int32_t parent = scene.nodes[n].parent; parent >= 0)
      world[n] = world[static_cast<std::size_t>(parent)] * world[n];
  return world;
}

Result<NodeMap> convertNodes(const Document& document, Scene& scene) {
  const tinygltf::Model& model = document.model();
  for (const tinygltf::Camera& camera : model.cameras) scene.cameras.push_back(convertCamera(camera));

  // Parents come first, in the order of the file; nodes of other scenes are left out.
  NodeMap map;
  map.scene_node.assign(model.nodes.size(), -1);
  std::vector<std::pair<int, std::int32_t>> pending;  // node of the file, new parent
  const std::vector<int> roots = rootsOf(model);
  for (auto it = roots.rbegin(); it != roots.rend(); ++it) pending.emplace_back(*it, -1);
  while (!pending.empty()) {
    const auto [index, parent] = pending.back();
    pending.pop_back();
    if (map.scene_node[static_cast<std::size_t>(index)] >= 0)
      return fail(document.file(), fmt::format("node {} stands twice in the scene", index),
                  "list each root node once");

    const tinygltf::Node& source = model.nodes[static_cast<std::size_t>(index)];
    gltf::Node node;
    node.name = source.name;
    node.parent = parent;
    map.parent_from_node.push_back(localMatrix(source));
    node.parent_from_node = glm::mat4(map.parent_from_node.back());
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r)
        if (!std::isfinite(node.parent_from_node[c][r]))
          return fail(document.file(), fmt::format("node {} has a transform that is not finite", index),
                      "reset its transform");
    node.mesh = source.mesh;
    node.camera = source.camera;
    node.light = lightOf(document.json()["nodes"][static_cast<std::size_t>(index)]);
    node.movable = isMovable(source);

    const auto added = static_cast<std::int32_t>(scene.nodes.size());
    map.scene_node[static_cast<std::size_t>(index)] = added;
    map.file_node.push_back(index);
    if (parent < 0) {
      scene.roots.push_back(added);
    } else {
      scene.nodes[static_cast<std::size_t>(parent)].children.push_back(added);
    }
    scene.nodes.push_back(std::move(node));
    for (auto child = source.children.rbegin(); child != source.children.rend(); ++child)
      pending.emplace_back(*child, added);
  }
  return map;
}

}  // namespace lambent::baker
