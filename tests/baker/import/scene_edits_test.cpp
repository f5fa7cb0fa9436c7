#include "baker/import/scene_edits.hpp"

#include <algorithm>
#include <string>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/support/material_values.hpp"

namespace lambent::baker {
namespace {

Scene twoBoxes() {
  Scene scene;
  scene.nodes.resize(3);
  scene.nodes[0].name = "box", scene.nodes[1].name = "lamp", scene.nodes[2].name = "other lamp";
  scene.nodes[1].light = scene.nodes[2].light = 0;
  scene.materials.resize(2);
  scene.materials[0].name = "red", scene.materials[1].name = "blue";
  scene.lights.push_back({.name = "bulb", .intensity = 5.0f});
  return scene;
}

SceneEdits someEdits() {
  SceneEdits edits;
  edits.nodes.push_back({0, "box", glm::translate(glm::mat4(1.0f), glm::vec3(1.0f, 2.0f, 3.0f))});
  SceneEdits::Material material;
  material.index = 1, material.name = "blue";
  material.values = {{"baseColor", glm::vec3(0.1f, 0.2f, 0.9f)}, {"roughness", 0.25f}, {"alpha", 0.5f}};
  edits.materials.push_back(material);
  SceneEdits::Light lamp;
  lamp.node = 1, lamp.name = "lamp", lamp.intensity = 9.0f;
  edits.lights.push_back(lamp);
  return edits;
}

TEST(SceneEdits, ChangeWhatTheyNameAndNothingElse) {
  Scene scene = twoBoxes();
  applyEdits(someEdits(), scene);
  EXPECT_EQ(glm::vec3(scene.nodes[0].parent_from_node[3]), glm::vec3(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(scene.materials[1].base_color, glm::vec4(0.1f, 0.2f, 0.9f, 0.5f));
  EXPECT_EQ(scene.materials[1].roughness, 0.25f);
  EXPECT_EQ(scene.materials[1].metallic, 1.0f);
  EXPECT_EQ(scene.materials[0].base_color, glm::vec4(1.0f));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(SceneEdits, OfOneLampLeaveAnotherOfTheSameLightAlone) {
  Scene scene = twoBoxes();
  applyEdits(someEdits(), scene);
  EXPECT_EQ(scene.lights[static_cast<std::size_t>(scene.nodes[1].light)].intensity, 9.0f);
  EXPECT_EQ(scene.lights[static_cast<std::size_t>(scene.nodes[2].light)].intensity, 5.0f);
}

TEST(SceneEdits, FollowNamesWhereAFileHasChanged) {
  Scene scene = twoBoxes();
  std::swap(scene.materials[0], scene.materials[1]);
  scene.nodes[0].name = "crate";
  applyEdits(someEdits(), scene);
  EXPECT_EQ(scene.materials[0].roughness, 0.25f);
  EXPECT_EQ(scene.materials[1].roughness, 1.0f);
  ASSERT_EQ(scene.warnings.size(), 1u);  // of the box, which is gone
  EXPECT_NE(scene.warnings.front().find("box"), std::string::npos);
}

TEST(SceneEdits, ComeBackFromTheirText) {
  const auto read = readEdits(editsText(someEdits()));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(*read, someEdits());
  EXPECT_FALSE(readEdits("{\"nodes\": [{\"index\": \"one\"}]}").has_value());
  EXPECT_FALSE(readEdits("nothing").has_value());
}

TEST(SceneEdits, HoldEveryValueOfAMaterialThatCanBeChanged) {
  const gltf::Material was = testing::materialWithEverything();
  const gltf::MaterialFactors factors = gltf::factorsOf(was);
  EXPECT_TRUE(editOf(0, was, was).values.empty());
  gltf::forEachLiveValue([&](const auto& field, const auto& live) {
    gltf::MaterialFactors other = factors;
    testing::change(other.*live.factor);
    const gltf::Material now = gltf::withFactors(was, other);
    SceneEdits edits;
    edits.materials = {editOf(0, was, now)};
    EXPECT_EQ(edits.materials[0].values.size(), 1u) << live.name;
    const auto read = readEdits(editsText(edits));
    ASSERT_TRUE(read) << live.name;
    EXPECT_EQ(*read, edits) << live.name;
    Scene scene;
    scene.materials = {was};
    scene.brdfs.resize(2);
    applyEdits(*read, scene);
    EXPECT_EQ(scene.materials[0].*field.member, now.*field.member) << live.name;
  });
}

TEST(SceneEdits, OfOneMaterialAddUpTheLaterOneAbove) {
  const SceneEdits::Material below{0, "red", {{"roughness", 0.1f}, {"metallic", 0.2f}}};
  const SceneEdits::Material above{0, "red", {{"roughness", 0.3f}, {"alpha", 0.4f}}};
  const SceneEdits::Material both{0, "red", {{"roughness", 0.3f}, {"metallic", 0.2f}, {"alpha", 0.4f}}};
  EXPECT_EQ(overlaid(below, above), both);
}

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
