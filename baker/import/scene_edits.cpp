#include "baker/import/scene_edits.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>
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

// Vectors and matrices are lists in JSON, matrices by columns as in glTF.
template <class T>
concept List = requires {
  T::length();
};

template <class T>
json toJson(const T& value) {
  if constexpr (List<T>)
    return std::vector(glm::value_ptr(value), glm::value_ptr(value) + sizeof(T) / sizeof(float));
  else
    return value;
}

template <class T>
void fromJson(const json& from, T& value) {
  if constexpr (List<T>)
    for (std::size_t i = 0; i < sizeof(T) / sizeof(float); ++i)
      glm::value_ptr(value)[i] = from.at(i).template get<float>();
  else
    from.get_to(value);
}

// Calls visit(name in JSON, member) for all that an edit holds but values of materials.
template <class Edit, class Visit>
void forEachMember(Edit& edit, const Visit& visit) {
  visit("name", edit.name);
  if constexpr (requires { edit.node; }) {
    visit("node", edit.node);
    visit("color", edit.color);
    visit("intensity", edit.intensity);
    visit("range", edit.range_m);
    visit("innerCone", edit.inner_cone_rad);
    visit("outerCone", edit.outer_cone_rad);
  } else {
    visit("index", edit.index);
  }
  if constexpr (requires { edit.parent_from_node; }) visit("matrix", edit.parent_from_node);
}

// Calls visit(name in JSON, list) for the lists of edits.
template <class Edits, class Visit>
void forEachList(Edits& edits, const Visit& visit) {
  visit("nodes", edits.nodes);
  visit("materials", edits.materials);
  visit("lights", edits.lights);
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
  forEachList(edits, [&](const char* list, const auto& all) {
    for (const auto& edit : all) {
      json& to = text[list].emplace_back();
      forEachMember(edit, [&](const char* name, const auto& member) { to[name] = toJson(member); });
      if constexpr (requires { edit.values; })
        for (const auto& [name, value] : edit.values)
          to[name] = std::visit([](const auto& v) { return toJson(v); }, value);
    }
  });
  return text.dump();
}

std::optional<SceneEdits> readEdits(const std::string& text) {
  const json from = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!from.is_object()) return std::nullopt;
  SceneEdits edits;
  try {
    forEachList(edits, [&](const char* list, auto& all) {
      for (const json& one : from.value(list, json::array())) {
        auto& edit = all.emplace_back();
        forEachMember(edit, [&](const char* name, auto& member) { fromJson(one.at(name), member); });
        if constexpr (requires { edit.values; })
          forEachValue([&]<class T>(const auto&, const gltf::LiveValue<T>& live) {
            if (one.contains(live.edit))
              fromJson(one.at(live.edit), edit.values[live.edit].template emplace<T>());
          });
      }
    });
  } catch (const json::exception&) {
    return std::nullopt;
  }
  return edits;
}

void joinScene(Scene from, const std::string& name, const glm::mat4& world_from_scene, Scene& to) {
  // Appends a list, and returns how many elements were there before.
  const auto append = [](auto& more, auto& list) {
    const auto first = static_cast<std::int32_t>(list.size());
    list.insert(list.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
    return first;
  };
  const auto added = [](auto& list, std::int32_t first) {
    return std::span(list).subspan(static_cast<std::size_t>(first));
  };
  const auto shift = [](std::int32_t& index, std::int32_t by) {
    if (index >= 0) index += by;
  };
  const std::int32_t nodes = append(from.nodes, to.nodes), meshes = append(from.meshes, to.meshes),
                     materials = append(from.materials, to.materials), brdfs = append(from.brdfs, to.brdfs),
                     textures = append(from.textures, to.textures), images = append(from.images, to.images),
                     cameras = append(from.cameras, to.cameras), lights = append(from.lights, to.lights),
                     animations = append(from.animations, to.animations),
                     volumes = append(from.volumes, to.volumes),
                     neighborhoods = append(from.neighborhoods, to.neighborhoods);
  append(from.warnings, to.warnings);
  const auto first_node = static_cast<std::uint32_t>(nodes);
  for (gltf::Node& node : added(to.nodes, nodes)) {
    shift(node.parent, nodes);
    for (std::int32_t& child : node.children) child += nodes;
    shift(node.mesh, meshes);
    shift(node.camera, cameras);
    shift(node.light, lights);
  }
  for (SceneMesh& mesh : added(to.meshes, meshes))
    for (ScenePrimitive& primitive : mesh.primitives) shift(primitive.material, materials);
  for (gltf::Material& material : added(to.materials, materials)) {
    gltf::forEachMaterialTexture(
        [&](const auto& field) { shift((material.*field.member).texture, textures); });
    shift(material.brdf, brdfs);
  }
  for (gltf::Texture& texture : added(to.textures, textures)) shift(texture.image, images);
  for (gltf::Animation& animation : added(to.animations, animations))
    for (gltf::AnimationChannel& channel : animation.channels) channel.node += first_node;
  for (SceneVolume& volume : added(to.volumes, volumes)) volume.node += first_node;
  for (NeighborhoodRequest& request : added(to.neighborhoods, neighborhoods)) request.node += first_node;

  const auto root = static_cast<std::int32_t>(to.nodes.size());
  gltf::Node place;
  place.name = name;
  place.parent_from_node = world_from_scene;
  for (const std::int32_t child : from.roots) {
    place.children.push_back(child + nodes);
    to.nodes[static_cast<std::size_t>(child + nodes)].parent = root;
  }
  to.nodes.push_back(std::move(place));
  to.roots.push_back(root);
}

}  // namespace lambent::baker
