#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

#include "baker/import/check.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/document.hpp"
#include "baker/import/scene_files.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

std::vector<std::size_t> childrenOf(const json& node) {
  return node.value("children", std::vector<std::size_t>());
}

std::vector<std::size_t> parentless(const Document& document) {
  const json& nodes = document.list("nodes");
  std::vector<bool> has_parent(nodes.size(), false);
  for (const json& node : nodes)
    for (const std::size_t child : childrenOf(node)) has_parent[child] = true;
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < has_parent.size(); ++i)
    if (!has_parent[i]) found.push_back(i);
  return found;
}

// Returns the roots of the default scene, or of the first one; in a file without scenes, all nodes without a
// parent.
std::vector<std::size_t> rootsOf(const Document& document) {
  const json& scenes = document.list("scenes");
  if (scenes.empty()) return parentless(document);
  return scenes.at(document.json.value("scene", std::size_t{0})).value("nodes", std::vector<std::size_t>());
}

// Mends have seen to the values.
gltf::Camera convertCamera(const json& camera) {
  gltf::Camera out;
  out.name = camera.value("name", "");
  out.perspective = camera.at("type") == "perspective";
  const json& lens = camera.at(out.perspective ? "perspective" : "orthographic");
  if (out.perspective) {
    out.yfov_rad = lens.at("yfov").get<float>();
    out.aspect = lens.value("aspectRatio", 0.0f);
  } else {
    out.xmag = lens.at("xmag").get<float>();
    out.ymag = lens.at("ymag").get<float>();
  }
  out.znear = lens.at("znear").get<float>();
  out.zfar = lens.value("zfar", 0.0f);
  return out;
}

}  // namespace

glm::dmat4 localMatrix(const json& node) {
  const auto numbers = [&](const char* key) { return node.value(key, std::vector<double>()); };
  if (const auto m = numbers("matrix"); !m.empty()) return glm::make_mat4(m.data());
  glm::dmat4 matrix(1.0);
  if (const auto t = numbers("translation"); !t.empty())
    matrix = glm::translate(matrix, glm::make_vec3(t.data()));
  if (const auto r = numbers("rotation"); !r.empty()) {
    const glm::dquat rotation(r[3], r[0], r[1], r[2]);
    // A quaternion of length zero rotates nothing.
    if (glm::length(rotation) > 0.0) matrix *= glm::mat4_cast(glm::normalize(rotation));
  }
  if (const auto s = numbers("scale"); !s.empty()) matrix = glm::scale(matrix, glm::make_vec3(s.data()));
  return matrix;
}

std::vector<glm::dmat4> fileWorldTransforms(const Document& document) {
  const json& nodes = document.list("nodes");
  std::vector<glm::dmat4> world;
  for (const json& node : nodes) world.push_back(localMatrix(node));
  std::vector<std::size_t> open = parentless(document);  // nodes whose matrices are those of the world
  while (!open.empty()) {
    const std::size_t parent = open.back();
    open.pop_back();
    for (const std::size_t child : childrenOf(nodes[parent])) {
      world[child] = world[parent] * world[child];
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
  for (const json& camera : document.list("cameras")) scene.cameras.push_back(convertCamera(camera));

  // Parents come first, in the order of the file; nodes of other scenes are left out.
  NodeMap map;
  map.scene_node.assign(document.list("nodes").size(), -1);
  std::vector<std::pair<std::size_t, std::int32_t>> pending;  // node of the file, new parent
  const std::vector<std::size_t> roots = rootsOf(document);
  for (auto it = roots.rbegin(); it != roots.rend(); ++it) pending.emplace_back(*it, -1);
  while (!pending.empty()) {
    const auto [index, parent] = pending.back();
    pending.pop_back();
    if (map.scene_node[index] >= 0)
      return fail(document.file(), fmt::format("node {} stands twice in the scene", index),
                  "list each root node once");

    const json& source = document.at("nodes", index);
    gltf::Node node;
    node.name = source.value("name", "");
    node.parent = parent;
    map.parent_from_node.push_back(localMatrix(source));
    node.parent_from_node = glm::mat4(map.parent_from_node.back());
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r)
        if (!std::isfinite(node.parent_from_node[c][r]))
          return fail(document.file(), fmt::format("node {} has a transform that is not finite", index),
                      "reset its transform");
    node.mesh = source.value("mesh", -1);
    node.camera = source.value("camera", -1);
    if (const json& light = memberOf(source, {"extensions", "KHR_lights_punctual", "light"});
        !light.is_null())
      node.light = light.get<std::int32_t>();
    node.movable = memberOf(source, {"extras", "lambent", "movable"}) == true;

    const auto added = static_cast<std::int32_t>(scene.nodes.size());
    map.scene_node[index] = added;
    map.file_node.push_back(static_cast<std::int32_t>(index));
    if (parent < 0) {
      scene.roots.push_back(added);
    } else {
      scene.nodes[static_cast<std::size_t>(parent)].children.push_back(added);
    }
    scene.nodes.push_back(std::move(node));
    const std::vector<std::size_t> children = childrenOf(source);
    for (auto child = children.rbegin(); child != children.rend(); ++child)
      pending.emplace_back(*child, added);
  }
  return map;
}

// Converts EXT_mesh_gpu_instancing: every instance becomes a node, so that later stages need not know of
// instances.

namespace {

constexpr std::size_t kMaxInstances = 1u << 20;  // each costs a name, draws and transfer of its own

struct Attribute {
  const char *name, *type;
  Floats values;
};

Result<void> readAttribute(const Document& document, const json& attributes, const std::string& node,
                           Attribute& attribute) {
  if (!attributes.contains(attribute.name)) return {};
  const std::string name = fmt::format("{} of the instances of {}", attribute.name, node);
  auto floats = readFloats(document, attributes[attribute.name].get<std::size_t>(), name, {attribute.type});
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
  Attribute translation{"TRANSLATION", "VEC3", {}}, rotation{"ROTATION", "VEC4", {}},
      scale{"SCALE", "VEC3", {}};
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
  std::size_t total = 0;
  for (std::size_t n = 0; n < map.scene_node.size(); ++n) {
    const json& instances = memberOf(document.at("nodes", n), {"extensions", kExtension});
    if (map.scene_node[n] < 0 || instances.is_null()) continue;
    const auto scene_node = map.scene_node[n];
    if (scene.nodes[static_cast<std::size_t>(scene_node)].mesh < 0) continue;
    if (auto done = expand(document, instances.at("attributes"), n, scene_node, total, map, scene); !done)
      return done;
  }
  return {};
}

// Converts KHR_lights_punctual. mend_looks.cpp has seen to types and ranges.

namespace {

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
  for (const json& light : memberOf(document.json, {"extensions", "KHR_lights_punctual", "lights"}))
    scene.lights.push_back(convertLight(light));
}

}  // namespace lambent::baker
