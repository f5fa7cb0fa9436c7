// Makes a registry with a small bundle (a table with a lamp on it, a ball and a camera, an emissive material,
// an animation), without files and GPU.
#pragma once

#include <string>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::editor::testing {

inline std::int32_t addNode(bundle::Description& d, std::string name, std::int32_t parent,
                            const glm::mat4& matrix) {
  const auto index = static_cast<std::int32_t>(d.nodes.size());
  gltf::Node& node = d.nodes.emplace_back();
  node.name = std::move(name);
  node.parent = parent;
  node.parent_from_node = matrix;
  if (parent < 0)
    d.roots.push_back(index);
  else
    d.nodes[static_cast<std::size_t>(parent)].children.push_back(index);
  return index;
}

// The hierarchy is table (scaled) > lamp (a spot), ball; the camera is beside it.
inline bundle::Description smallDescription() {
  bundle::Description d;
  const std::int32_t table = addNode(d, "table", -1, glm::scale(glm::mat4(1.0f), glm::vec3(2.0f)));
  const std::int32_t lamp =
      addNode(d, "lamp", table, glm::translate(glm::mat4(1.0f), glm::vec3(0.0f, 1.0f, 0.0f)));
  addNode(d, "ball", table, glm::translate(glm::mat4(1.0f), glm::vec3(0.5f, 0.25f, 0.0f)));
  const std::int32_t camera =
      addNode(d, "camera", -1, glm::translate(glm::mat4(1.0f), glm::vec3(0.0f, 1.0f, 5.0f)));
  gltf::Light light;
  light.name = "lamp";
  light.type = static_cast<decltype(light.type)>(2);  // spot
  light.intensity = 7.0f;
  d.lights.push_back(light);
  d.nodes[static_cast<std::size_t>(lamp)].light = 0;
  d.cameras.emplace_back();
  d.nodes[static_cast<std::size_t>(camera)].camera = 0;
  d.materials.emplace_back().name = "tube";
  bundle::Group group;
  group.name = "scene";
  group.node = -1;
  group.bounds_min = glm::vec3(-1.0f);
  group.bounds_max = glm::vec3(1.0f);
  group.lights.push_back({.kind = bundle::GroupLight::Kind::Material, .index = 0, .color = glm::vec3(3.0f)});
  d.groups.push_back(group);
  bundle::Mesh mesh;
  bundle::Primitive& primitive = mesh.primitives.emplace_back();
  primitive.material = 0;
  primitive.bounds_min = glm::vec3(-0.5f);
  primitive.bounds_max = glm::vec3(0.5f);
  d.meshes.push_back(mesh);
  bundle::Draw draw;
  draw.node = static_cast<std::uint32_t>(table);
  draw.group = 0;
  d.draws.push_back(draw);
  gltf::Animation animation;
  animation.name = "roll";
  gltf::AnimationChannel& channel = animation.channels.emplace_back();
  channel.node = 2;
  channel.times_s = {0.0f, 1.0f};
  channel.values = {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f};
  d.animations.push_back(animation);
  return d;
}

struct SmallWorld {
  SmallWorld() { add(0); }
  scene::SceneInstance& add(std::uint32_t number) {
    auto made = scene::instantiate(
        registry, description, {.bundle_index = number, .bundle_id = "small.lmb.glb", .instance = number});
    return instance = std::move(*made);
  }
  ecs::Entity node(std::string_view name) {
    for (const ecs::Entity entity : instance.nodes)
      if (registry.get<scene::Name>(entity).value == name) return entity;
    return {};
  }

  bundle::Description description = smallDescription();
  ecs::Registry registry;
  scene::SceneInstance instance;
};

}  // namespace lambent::editor::testing
