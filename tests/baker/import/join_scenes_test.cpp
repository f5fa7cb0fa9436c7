#include <algorithm>
#include <string>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "baker/import/scene_edits.hpp"

namespace lambent::baker {
namespace {

// Makes a body below a pivot, with a texture of its own, a lamp, and an animation of the body.
Scene scene(const std::string& name, float height) {
  Scene made;
  made.nodes.resize(2);
  made.nodes[0].name = name + " pivot", made.nodes[0].children = {1};
  made.nodes[0].parent_from_node = glm::translate(glm::mat4(1.0f), glm::vec3(0.0f, height, 0.0f));
  made.nodes[1].name = name, made.nodes[1].parent = 0, made.nodes[1].mesh = 0, made.nodes[1].light = 0;
  made.roots = {0};
  made.meshes.push_back({name, {{.mesh = {}, .material = 0}, {.mesh = {}, .material = -1}}});
  gltf::Material& material = made.materials.emplace_back();
  material.name = name, material.brdf = 0;
  material.base_color_texture.texture = material.normal_texture.texture = 0;
  made.brdfs.push_back({name, {}});
  made.textures.push_back({.image = 0, .sampler = {}});
  made.images.push_back({name, "image/png", {}});
  made.lights.push_back({.name = name});
  made.animations.push_back({name, {{.node = 1, .times_s = {}, .values = {}}}});
  made.volumes.push_back({.name = name, .node = 1, .density = {}});
  return made;
}

TEST(JoinScene, PartsOfBothAreFoundByTheirIndices) {
  Scene both = scene("chair", 1.0f);
  joinScene(scene("table", 2.0f), "room", glm::mat4(1.0f), both);
  const auto find = [&](const std::string& name) {
    const auto found = std::find_if(both.nodes.begin(), both.nodes.end(),
                                    [&](const gltf::Node& node) { return node.name == name; });
    return static_cast<std::size_t>(found - both.nodes.begin());
  };
  for (const std::string name : {"chair", "table"}) {
    const std::size_t at = find(name);
    const gltf::Node& node = both.nodes.at(at);
    const auto part = [](std::int32_t index) { return static_cast<std::size_t>(index); };
    EXPECT_EQ(both.nodes.at(part(node.parent)).name, name + " pivot");
    EXPECT_EQ(both.nodes.at(part(node.parent)).children, std::vector{static_cast<std::int32_t>(at)});
    EXPECT_EQ(both.lights.at(part(node.light)).name, name);
    const SceneMesh& mesh = both.meshes.at(part(node.mesh));
    EXPECT_EQ(mesh.name, name);
    EXPECT_EQ(mesh.primitives[1].material, -1);
    const gltf::Material& material = both.materials.at(part(mesh.primitives[0].material));
    EXPECT_EQ(material.name, name);
    EXPECT_EQ(both.brdfs.at(part(material.brdf)).name, name);
    EXPECT_EQ(material.emissive_texture.texture, -1);
    for (const auto& ref : {material.base_color_texture, material.normal_texture})
      EXPECT_EQ(both.images.at(part(both.textures.at(part(ref.texture)).image)).name, name);
    const std::size_t which = name == "chair" ? 0 : 1;
    EXPECT_EQ(both.animations.at(which).channels[0].node, at);
    EXPECT_EQ(both.volumes.at(which).node, at);
  }
}

TEST(JoinScene, StandsWhereItIsPutAndTheFirstStaysInItsPlace) {
  Scene both = scene("chair", 1.0f);
  joinScene(scene("table", 2.0f), "room", glm::translate(glm::mat4(1.0f), glm::vec3(5.0f, 0.0f, 0.0f)), both);
  ASSERT_EQ(both.roots.size(), 2u);
  const std::vector<glm::mat4> world = gltf::worldTransforms(both.nodes);
  EXPECT_EQ(glm::vec3(world[1][3]), glm::vec3(0.0f, 1.0f, 0.0f));
  EXPECT_EQ(glm::vec3(world[3][3]), glm::vec3(5.0f, 2.0f, 0.0f));
}

}  // namespace
}  // namespace lambent::baker
