#include "baker/import/scene_edits.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

// Returns the part that an edit refers to: that of its index and name, else the only one of its name.
template <typename T>
std::optional<std::size_t> meant(const std::vector<T>& parts, std::uint32_t index, const std::string& name) {
  if (index < parts.size() && parts[index].name == name) return index;
  const auto named = [&](const T& part) { return part.name == name; };
  if (name.empty() || std::count_if(parts.begin(), parts.end(), named) != 1) return std::nullopt;
  return static_cast<std::size_t>(std::find_if(parts.begin(), parts.end(), named) - parts.begin());
}

void passedOver(const char* kind, const std::string& name, Scene& scene) {
  scene.warnings.push_back(fmt::format(
      "the edit of {} \"{}\" is passed over: the file no longer has just one of that name", kind, name));
}

// Calls visit for the values that have an edit of their own.
template <class Visit>
void forEachValue(const Visit& visit) {
  gltf::forEachLiveValue([&](const auto& field, const auto& live) {
    if (live.edit) visit(field, live);
  });
}

void applyNode(const SceneEdits::Node& edit, Scene& scene) {
  const auto at = meant(scene.nodes, edit.index, edit.name);
  if (!at) return passedOver("node", edit.name, scene);
  gltf::Node& node = scene.nodes[*at];
  node.parent_from_node = edit.parent_from_node;
  // Channels replace single parts of the transform, so an animated node keeps these parts.
  if (!node.animated) node.trs.reset();
}

void applyMaterial(const SceneEdits::Material& edit, Scene& scene) {
  const auto at = meant(scene.materials, edit.index, edit.name);
  if (!at) return passedOver("material", edit.name, scene);
  gltf::Material& material = scene.materials[*at];
  forEachValue([&]<class T>(const auto& field, const gltf::LiveValue<T>& live) {
    const auto found = edit.values.find(live.edit);
    if (found == edit.values.end()) return;
    const T value = std::get<T>(found->second);
    if constexpr (std::is_same_v<T, std::int32_t>)  // the file may not have this measured BRDF any more
      if (value >= static_cast<std::int32_t>(scene.brdfs.size())) return;
    gltf::putLive(value, material.*field.member);
  });
}

// Nodes may share a light, so the edited node gets a light of its own.
void applyLight(const SceneEdits::Light& edit, Scene& scene) {
  const auto at = meant(scene.nodes, edit.node, edit.name);
  if (!at || scene.nodes[*at].light < 0) return passedOver("lamp", edit.name, scene);
  gltf::Light light = scene.lights[static_cast<std::size_t>(scene.nodes[*at].light)];
  light.color = edit.color;
  light.intensity = edit.intensity;
  light.range_m = edit.range_m;
  light.inner_cone_rad = edit.inner_cone_rad, light.outer_cone_rad = edit.outer_cone_rad;
  scene.nodes[*at].light = static_cast<std::int32_t>(scene.lights.size());
  scene.lights.push_back(std::move(light));
}

json vectorJson(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}
glm::vec3 vectorFrom(const json& value) {
  return {value.at(0).get<float>(), value.at(1).get<float>(), value.at(2).get<float>()};
}

json materialJson(const SceneEdits::Material& m) {
  json to = {{"index", m.index}, {"name", m.name}};
  for (const auto& [name, value] : m.values)
    to[name] = std::visit(
        []<class T>(const T& v) -> json {
          if constexpr (std::is_same_v<T, glm::vec3>)
            return vectorJson(v);
          else
            return v;
        },
        value);
  return to;
}

SceneEdits::Material materialFrom(const json& from) {
  SceneEdits::Material m;
  from.at("index").get_to(m.index), from.at("name").get_to(m.name);
  forEachValue([&]<class T>(const auto&, const gltf::LiveValue<T>& live) {
    if (!from.contains(live.edit)) return;
    if constexpr (std::is_same_v<T, glm::vec3>)
      m.values[live.edit] = vectorFrom(from.at(live.edit));
    else
      m.values[live.edit] = from.at(live.edit).template get<T>();
  });
  return m;
}

json nodeJson(const SceneEdits::Node& n) {
  json matrix = json::array();  // by columns, as in glTF
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) matrix.push_back(n.parent_from_node[column][row]);
  return {{"index", n.index}, {"name", n.name}, {"matrix", matrix}};
}

SceneEdits::Node nodeFrom(const json& from) {
  SceneEdits::Node n;
  from.at("index").get_to(n.index), from.at("name").get_to(n.name);
  for (int i = 0; i < 16; ++i)
    n.parent_from_node[i / 4][i % 4] = from.at("matrix").at(static_cast<std::size_t>(i)).get<float>();
  return n;
}

json lightJson(const SceneEdits::Light& l) {
  return {{"node", l.node},
          {"name", l.name},
          {"color", vectorJson(l.color)},
          {"intensity", l.intensity},
          {"range", l.range_m},
          {"innerCone", l.inner_cone_rad},
          {"outerCone", l.outer_cone_rad}};
}

SceneEdits::Light lightFrom(const json& from) {
  SceneEdits::Light l;
  from.at("node").get_to(l.node), from.at("name").get_to(l.name);
  l.color = vectorFrom(from.at("color"));
  from.at("intensity").get_to(l.intensity), from.at("range").get_to(l.range_m);
  from.at("innerCone").get_to(l.inner_cone_rad), from.at("outerCone").get_to(l.outer_cone_rad);
  return l;
}

}  // namespace

SceneEdits::Material editOf(std::uint32_t index, const gltf::Material& was, const gltf::Material& now) {
  SceneEdits::Material edit{index, was.name, {}};
  forEachValue([&]<class T>(const auto& field, const gltf::LiveValue<T>& live) {
    const T value = gltf::liveFrom<T>(now.*field.member);
    if (value != gltf::liveFrom<T>(was.*field.member)) edit.values[live.edit] = value;
  });
  return edit;
}

SceneEdits::Material overlaid(const SceneEdits::Material& below, SceneEdits::Material above) {
  above.values.insert(below.values.begin(), below.values.end());
  return above;
}

void applyEdits(const SceneEdits& edits, Scene& scene) {
  for (const SceneEdits::Node& edit : edits.nodes) applyNode(edit, scene);
  for (const SceneEdits::Material& edit : edits.materials) applyMaterial(edit, scene);
  for (const SceneEdits::Light& edit : edits.lights) applyLight(edit, scene);
}

std::string editsText(const SceneEdits& edits) {
  json text = json::object();
  for (const SceneEdits::Node& edit : edits.nodes) text["nodes"].push_back(nodeJson(edit));
  for (const SceneEdits::Material& edit : edits.materials) text["materials"].push_back(materialJson(edit));
  for (const SceneEdits::Light& edit : edits.lights) text["lights"].push_back(lightJson(edit));
  return text.dump();
}

std::optional<SceneEdits> readEdits(const std::string& text) {
  const json from = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!from.is_object()) return std::nullopt;
  SceneEdits edits;
  try {
    for (const json& edit : from.value("nodes", json::array())) edits.nodes.push_back(nodeFrom(edit));
    for (const json& edit : from.value("materials", json::array()))
      edits.materials.push_back(materialFrom(edit));
    for (const json& edit : from.value("lights", json::array())) edits.lights.push_back(lightFrom(edit));
  } catch (const json::exception&) {
    return std::nullopt;
  }
  return edits;
}

namespace {

// Offsets say where the parts of the added scene begin in the other.
struct Offsets {
  std::int32_t nodes, meshes, materials, brdfs, textures, images, cameras, lights;
};

template <typename T>
std::int32_t countOf(const std::vector<T>& list) {
  return static_cast<std::int32_t>(list.size());
}

void shift(std::int32_t& index, std::int32_t by) {
  if (index >= 0) index += by;
}

void shift(gltf::Node& node, const Offsets& by) {
  shift(node.parent, by.nodes);
  for (std::int32_t& child : node.children) child += by.nodes;
  shift(node.mesh, by.meshes);
  shift(node.camera, by.cameras);
  shift(node.light, by.lights);
}

void shift(gltf::Material& material, const Offsets& by) {
  gltf::forEachMaterialTexture(
      [&](const auto& field) { shift((material.*field.member).texture, by.textures); });
  shift(material.brdf, by.brdfs);
}

template <typename T>
void append(std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

void joinScene(Scene from, const std::string& name, const glm::mat4& world_from_scene, Scene& to) {
  const Offsets by{countOf(to.nodes),    countOf(to.meshes), countOf(to.materials), countOf(to.brdfs),
                   countOf(to.textures), countOf(to.images), countOf(to.cameras),   countOf(to.lights)};
  for (gltf::Node& node : from.nodes) shift(node, by);
  for (SceneMesh& mesh : from.meshes)
    for (ScenePrimitive& primitive : mesh.primitives) shift(primitive.material, by.materials);
  for (gltf::Material& material : from.materials) shift(material, by);
  for (gltf::Texture& texture : from.textures) shift(texture.image, by.images);
  const auto first_node = static_cast<std::uint32_t>(by.nodes);
  for (gltf::Animation& animation : from.animations)
    for (gltf::AnimationChannel& channel : animation.channels) channel.node += first_node;
  for (SceneVolume& volume : from.volumes) volume.node += first_node;
  for (NeighborhoodRequest& request : from.neighborhoods) request.node += first_node;

  append(from.nodes, to.nodes);
  append(from.meshes, to.meshes);
  append(from.materials, to.materials);
  append(from.brdfs, to.brdfs);
  append(from.textures, to.textures);
  append(from.images, to.images);
  append(from.cameras, to.cameras);
  append(from.lights, to.lights);
  append(from.animations, to.animations);
  append(from.volumes, to.volumes);
  append(from.neighborhoods, to.neighborhoods);
  append(from.warnings, to.warnings);

  const std::int32_t root = countOf(to.nodes);
  gltf::Node& place = to.nodes.emplace_back();
  place.name = name;
  place.parent_from_node = world_from_scene;
  for (const std::int32_t child : from.roots) place.children.push_back(child + by.nodes);
  const std::vector<std::int32_t> children = place.children;
  for (const std::int32_t child : children) to.nodes[static_cast<std::size_t>(child)].parent = root;
  to.roots.push_back(root);
}

}  // namespace lambent::baker
