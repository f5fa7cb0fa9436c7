// Converts EXT_mesh_gpu_instancing: every instance becomes a node, so that later stages need not know of
// instances.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/accessor.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/hints.hpp"

namespace lambent::baker {
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

}  // namespace lambent::baker
