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
#include "runtime/base/finite.hpp"

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
  readMember(lens, "yfov", out.yfov_rad);
  readMember(lens, "aspectRatio", out.aspect);
  readMember(lens, "xmag", out.xmag);
  readMember(lens, "ymag", out.ymag);
  readMember(lens, "znear", out.znear);
  readMember(lens, "zfar", out.zfar);
  return out;
}

}  // namespace

NodeParts partsOf(const json& node) {
  NodeParts parts;
  readMember(node, "translation", parts.translation);
  readMember(node, "scale", parts.scale);
  glm::dvec4 r(0.0, 0.0, 0.0, 1.0);
  readMember(node, "rotation", r);
  // A quaternion of length zero rotates nothing.
  if (glm::length(r) > 0.0) parts.rotation = glm::normalize(glm::dquat(r.w, r.x, r.y, r.z));
  return parts;
}

glm::dmat4 localMatrix(const json& node) {
  if (node.contains("matrix")) return glm::make_mat4(node["matrix"].get<std::vector<double>>().data());
  const NodeParts parts = partsOf(node);
  return glm::scale(glm::translate(glm::dmat4(1.0), parts.translation) * glm::mat4_cast(parts.rotation),
                    parts.scale);
}

std::vector<glm::dmat4> fileWorldTransforms(const Document& document) {
  const json& nodes = document.list("nodes");
  std::vector<glm::dmat4> world;
  for (const json& node : nodes) world.push_back(localMatrix(node));
  std::vector<std::size_t> open = parentless(document);  // nodes whose matrices are those of the world
  std::vector<bool> placed(nodes.size(), false);         // a node outside the scene may have two parents
  while (!open.empty()) {
    const std::size_t parent = open.back();
    open.pop_back();
    for (const std::size_t child : childrenOf(nodes[parent])) {
      if (placed[child]) continue;
      placed[child] = true;
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

NodeMap convertNodes(const Document& document, Scene& scene) {
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
      throw Error{{},
                  fmt::format("node {} stands twice in the scene, or is its own ancestor", index),
                  "give each node one parent, and list each root once"};

    const json& source = document.at("nodes", index);
    gltf::Node node;
    node.name = source.value("name", "");
    node.parent = parent;
    map.parent_from_node.push_back(localMatrix(source));
    node.parent_from_node = glm::mat4(map.parent_from_node.back());
    if (!isFinite(node.parent_from_node))
      throw Error{
          {}, fmt::format("node {} has a transform that is not finite", index), "reset its transform"};
    node.mesh = source.value("mesh", -1);
    node.camera = source.value("camera", -1);
    if (const json& light = memberOf(source, {"extensions", "KHR_lights_punctual", "light"});
        !light.is_null())
      node.light = light.get<std::int32_t>();
    node.movable = memberOf(source, {"extras", "lambent", "movable"}) == true;

    const auto added = static_cast<std::int32_t>(scene.nodes.size());
    map.scene_node[index] = added;
    map.file_node.push_back(static_cast<std::int32_t>(index));
    auto& siblings = parent < 0 ? scene.roots : scene.nodes[static_cast<std::size_t>(parent)].children;
    siblings.push_back(added);
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
  Floats values = {};

  const float* at(std::size_t instance) const { return &values.values[instance * values.components]; }
};

glm::mat4 instanceMatrix(const Attribute& translation, const Attribute& rotation, const Attribute& scale,
                         std::size_t i) {
  gltf::Trs trs;
  if (translation.values.count() > 0) trs.translation = glm::make_vec3(translation.at(i));
  if (rotation.values.count() > 0) {
    const float* r = rotation.at(i);
    const glm::quat turn(r[3], r[0], r[1], r[2]);
    // Quantized quaternions are not exactly unit; one of length zero rotates nothing.
    if (glm::length(turn) > 0.0f) trs.rotation = glm::normalize(turn);
  }
  if (scale.values.count() > 0) trs.scale = glm::make_vec3(scale.at(i));
  return trs.matrix();
}

void expand(const Document& document, const json& attributes, std::size_t file_node, std::int32_t scene_node,
            std::size_t& total, NodeMap& map, Scene& scene) {
  const std::string name = fmt::format("node {}", file_node);
  Attribute translation{"TRANSLATION", "VEC3"}, rotation{"ROTATION", "VEC4"}, scale{"SCALE", "VEC3"};
  std::size_t count = 0;
  bool any = false;
  for (Attribute* attribute : {&translation, &rotation, &scale}) {
    if (!attributes.contains(attribute->name)) continue;
    any = true;
    attribute->values =
        readFloats(document, attributes[attribute->name].get<std::size_t>(),
                   fmt::format("{} of the instances of {}", attribute->name, name), {attribute->type});
    const Floats& floats = attribute->values;
    for (std::size_t i = 0; i < floats.values.size(); ++i)
      if (!std::isfinite(floats.values[i]))
        refuse("{}: {} of instance {} is not finite", name, attribute->name, i / floats.components);
    const std::size_t here = floats.count();
    if (here != 0 && count != 0 && here != count)
      refuse("{}: {} is there for {} instances where others are for {}", name, attribute->name, here, count);
    if (here != 0) count = here;
  }
  if (count == 0) {
    // It has no instance, unless it has only custom attributes: then it is drawn once.
    if (any) scene.nodes[static_cast<std::size_t>(scene_node)].mesh = -1;
    return;
  }
  total += count;
  if (total > kMaxInstances)
    throw Error{{},
                fmt::format("{} brings the scene to more than {} instances", name, kMaxInstances),
                "import it in parts"};
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
}

}  // namespace

void convertInstances(const Document& document, NodeMap& map, Scene& scene) {
  std::size_t total = 0;
  for (std::size_t n = 0; n < map.scene_node.size(); ++n) {
    const json& instances = memberOf(document.at("nodes", n), {"extensions", "EXT_mesh_gpu_instancing"});
    const std::int32_t scene_node = map.scene_node[n];
    if (scene_node < 0 || instances.is_null() || scene.nodes[static_cast<std::size_t>(scene_node)].mesh < 0)
      continue;
    expand(document, instances.at("attributes"), n, scene_node, total, map, scene);
  }
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
  readMember(source, "color", light.color);
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
