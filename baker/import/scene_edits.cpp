#include "baker/import/scene_edits.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lambent::baker {

namespace {

using nlohmann::json;

// The part that was meant: of that index and name, else the only one of that name.
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

// Every value that a material has a place of its own for: its name in files, what is edited, that place.
template <typename Edit, typename Visitor>
void forEachValue(Edit& edit, const Visitor& visit) {
  using M = gltf::Material;
  visit("emissive", edit.emissive, &M::emissive);
  visit("specularColor", edit.specular_color, &M::specular_color);
  visit("metallic", edit.metallic, &M::metallic);
  visit("roughness", edit.roughness, &M::roughness);
  visit("ior", edit.ior, &M::ior);
  visit("specular", edit.specular, &M::specular);
  visit("anisotropy", edit.anisotropy, &M::anisotropy);
  visit("anisotropyRotation", edit.anisotropy_rotation, &M::anisotropy_rotation_rad);
  visit("normalScale", edit.normal_scale, &M::normal_scale);
  visit("alphaCutoff", edit.alpha_cutoff, &M::alpha_cutoff);
}

void applyNode(const SceneEdits::Node& edit, Scene& scene) {
  const auto at = meant(scene.nodes, edit.index, edit.name);
  if (!at) return passedOver("node", edit.name, scene);
  gltf::Node& node = scene.nodes[*at];
  node.parent_from_node = edit.parent_from_node;
  // Channels replace parts of what they move; the others stay as edited only where there are none.
  if (!node.animated) node.trs.reset();
}

void applyMaterial(const SceneEdits::Material& edit, Scene& scene) {
  const auto at = meant(scene.materials, edit.index, edit.name);
  if (!at) return passedOver("material", edit.name, scene);
  gltf::Material& m = scene.materials[*at];
  forEachValue(edit, [&](const char*, const auto& value, auto gltf::Material::*place) {
    if (value) m.*place = *value;
  });
  if (edit.base_color) m.base_color = glm::vec4(*edit.base_color, m.base_color.a);
  if (edit.alpha) m.base_color.a = *edit.alpha;
  if (edit.brdf && *edit.brdf < static_cast<std::int32_t>(scene.brdfs.size())) m.brdf = *edit.brdf;
}

// Nodes may share a light: the edited one gets one of its own.
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

json jsonOf(float value) {
  return value;
}
json jsonOf(const glm::vec3& value) {
  return vectorJson(value);
}
void readInto(const json& from, std::optional<float>& value) {
  value = from.get<float>();
}
void readInto(const json& from, std::optional<glm::vec3>& value) {
  value = vectorFrom(from);
}

json materialJson(const SceneEdits::Material& m) {
  json to = {{"index", m.index}, {"name", m.name}};
  forEachValue(m, [&](const char* name, const auto& value, auto) {
    if (value) to[name] = jsonOf(*value);
  });
  if (m.base_color) to["baseColor"] = vectorJson(*m.base_color);
  if (m.alpha) to["alpha"] = *m.alpha;
  if (m.brdf) to["brdf"] = *m.brdf;
  return to;
}

SceneEdits::Material materialFrom(const json& from) {
  SceneEdits::Material m;
  from.at("index").get_to(m.index), from.at("name").get_to(m.name);
  forEachValue(m, [&](const char* name, auto& value, auto) {
    if (from.contains(name)) readInto(from.at(name), value);
  });
  if (from.contains("baseColor")) readInto(from.at("baseColor"), m.base_color);
  if (from.contains("alpha")) readInto(from.at("alpha"), m.alpha);
  if (from.contains("brdf")) m.brdf = from.at("brdf").get<std::int32_t>();
  return m;
}

json nodeJson(const SceneEdits::Node& n) {
  json matrix = json::array();  // by columns, as glTF has them
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

SceneEdits::Material overlaid(SceneEdits::Material below, const SceneEdits::Material& above) {
  const SceneEdits::Material old = below;
  below = above;
  const auto keep = [](auto& value, const auto& otherwise) {
    if (!value) value = otherwise;
  };
  keep(below.base_color, old.base_color), keep(below.emissive, old.emissive);
  keep(below.specular_color, old.specular_color), keep(below.alpha, old.alpha);
  keep(below.metallic, old.metallic), keep(below.roughness, old.roughness), keep(below.ior, old.ior);
  keep(below.specular, old.specular), keep(below.anisotropy, old.anisotropy);
  keep(below.anisotropy_rotation, old.anisotropy_rotation), keep(below.normal_scale, old.normal_scale);
  keep(below.alpha_cutoff, old.alpha_cutoff), keep(below.brdf, old.brdf);
  return below;
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

}  // namespace lambent::baker
