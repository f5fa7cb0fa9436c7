#include "baker/import/join_scenes.hpp"

#include <cstdint>
#include <iterator>
#include <utility>

#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

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
