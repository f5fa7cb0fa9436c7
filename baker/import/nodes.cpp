#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/document.hpp"
#include "baker/import/error_text.hpp"
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

// Converts EXT_mesh_gpu_instancing: every instance becomes a node, so that later stages need not know of
// instances.

namespace {

using nlohmann::json;

constexpr std::size_t kMaxInstances = 1u << 20;  // each costs a name, draws and transfer of its own

struct Attribute {
  const char* name;
  int components;
  Floats values;
};

Result<void> readAttribute(const Document& document, const json& attributes, const std::string& node,
                           Attribute& attribute) {
  if (!attributes.contains(attribute.name)) return {};
  const std::string name = fmt::format("{} of the instances of {}", attribute.name, node);
  auto floats = readFloats(document, attributes[attribute.name].get<int>(), name, {attribute.components},
                           static_cast<std::size_t>(attribute.components));
  if (!floats) return failAgain(std::move(floats.error()));
  for (std::size_t i = 0; i < floats->values.size(); ++i)
    if (!std::isfinite(floats->values[i]))
      return fail(
          document.file(),
          fmt::format("{}: {} of instance {} is not finite", node, attribute.name, i / floats->components),
          kExportAgain);
  attribute.values = std::move(*floats);
  return {};
}

const float* at(const Attribute& attribute, std::size_t instance) {
  return &attribute.values.values[instance * attribute.values.components];
}

glm::mat4 instanceMatrix(const Attribute& translation, const Attribute& rotation, const Attribute& scale,
                         std::size_t i) {
  gltf::Trs trs;
  if (translation.values.count() > 0) {
    const float* t = at(translation, i);
    trs.translation = {t[0], t[1], t[2]};
  }
  if (rotation.values.count() > 0) {
    const float* r = at(rotation, i);
    const glm::quat turn(r[3], r[0], r[1], r[2]);
    // Quantized quaternions are not exactly unit; one of length zero rotates nothing.
    if (glm::length(turn) > 0.0f) trs.rotation = glm::normalize(turn);
  }
  if (scale.values.count() > 0) {
    const float* s = at(scale, i);
    trs.scale = {s[0], s[1], s[2]};
  }
  return trs.matrix();
}

Result<void> expand(const Document& document, const json& attributes, std::size_t file_node,
                    std::int32_t scene_node, std::size_t& total, NodeMap& map, Scene& scene) {
  const std::string name = fmt::format("node {}", file_node);
  Attribute translation{"TRANSLATION", 3, {}}, rotation{"ROTATION", 4, {}}, scale{"SCALE", 3, {}};
  std::size_t count = 0;
  for (Attribute* attribute : {&translation, &rotation, &scale}) {
    if (auto read = readAttribute(document, attributes, name, *attribute); !read) return read;
    const std::size_t here = attribute->values.count();
    if (here != 0 && count != 0 && here != count)
      return fail(document.file(),
                  fmt::format("{}: {} is there for {} instances where others are for {}", name,
                              attribute->name, here, count),
                  kExportAgain);
    if (here != 0) count = here;
  }
  if (count == 0) {
    // It has no instance, unless it has only custom attributes: then it is drawn once.
    for (const Attribute* attribute : {&translation, &rotation, &scale})
      if (attributes.contains(attribute->name)) scene.nodes[static_cast<std::size_t>(scene_node)].mesh = -1;
    return {};
  }
  total += count;
  if (total > kMaxInstances)
    return fail(document.file(),
                fmt::format("{} brings the scene to more than {} instances", name, kMaxInstances),
                "import it in parts");
  const gltf::Node source = scene.nodes[static_cast<std::size_t>(scene_node)];
  for (std::size_t i = 0; i < count; ++i) {
    gltf::Node node;
    node.name = fmt::format("{}[{}]", source.name.empty() ? name : source.name, i);
    node.parent = scene_node;
    node.parent_from_node = instanceMatrix(translation, rotation, scale, i);
    node.mesh = source.mesh;
    scene.nodes[static_cast<std::size_t>(scene_node)].children.push_back(
        static_cast<std::int32_t>(scene.nodes.size()));
    map.parent_from_node.emplace_back(node.parent_from_node);
    scene.nodes.push_back(std::move(node));
  }
  scene.nodes[static_cast<std::size_t>(scene_node)].mesh = -1;
  return {};
}

}  // namespace

Result<void> convertInstances(const Document& document, NodeMap& map, Scene& scene) {
  constexpr const char* kExtension = "EXT_mesh_gpu_instancing";
  if (map.scene_node.empty()) return {};
  const json& nodes = document.json()["nodes"];
  std::size_t total = 0;
  for (std::size_t n = 0; n < map.scene_node.size(); ++n) {
    if (map.scene_node[n] < 0 || !nodes[n].contains("extensions") ||
        !nodes[n]["extensions"].contains(kExtension))
      continue;
    const auto scene_node = map.scene_node[n];
    if (scene.nodes[static_cast<std::size_t>(scene_node)].mesh < 0) continue;
    const json& attributes = nodes[n]["extensions"][kExtension]["attributes"];
    if (auto done = expand(document, attributes, n, scene_node, total, map, scene); !done) return done;
  }
  return {};
}

// Converts KHR_lights_punctual. mend_looks.cpp has seen to types and ranges.

namespace {

using nlohmann::json;

gltf::Light convertLight(const json& source) {
  gltf::Light light;
  light.name = source.value("name", "");
  const std::string type = source.value("type", "");
  light.type = type == "directional" ? gltf::Light::Type::Directional
               : type == "spot"      ? gltf::Light::Type::Spot
                                     : gltf::Light::Type::Point;
  if (source.contains("color"))
    for (int c = 0; c < 3; ++c) light.color[c] = source["color"][static_cast<std::size_t>(c)].get<float>();
  light.intensity = source.value("intensity", 1.0f);
  // glTF's colours end at 1, so brighter ones are taken as intensity.
  const float largest = std::max({light.color.x, light.color.y, light.color.z});
  if (largest > 1.0f) {
    light.color /= largest;
    light.intensity *= largest;
  }
  light.range_m = source.value("range", 0.0f);
  if (light.type == gltf::Light::Type::Spot) {
    // This is the largest float below a right angle; the next one exceeds pi/2, which glTF forbids.
    const float widest = std::nextafter(std::numbers::pi_v<float> / 2, 0.0f);
    const json& spot = source["spot"];
    light.outer_cone_rad = std::min(spot.value("outerConeAngle", light.outer_cone_rad), widest);
    light.inner_cone_rad =
        std::min(spot.value("innerConeAngle", 0.0f), std::nextafter(light.outer_cone_rad, 0.0f));
  }
  return light;
}

}  // namespace

void convertLights(const Document& document, Scene& scene) {
  const json& root = document.json();
  if (!root.contains("extensions") || !root["extensions"].contains("KHR_lights_punctual")) return;
  const json& extension = root["extensions"]["KHR_lights_punctual"];
  if (!extension.contains("lights")) return;
  for (const json& light : extension["lights"]) scene.lights.push_back(convertLight(light));
}

}  // namespace lambent::baker
