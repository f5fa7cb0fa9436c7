#include "baker/import/scene_edits.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

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
  material.base_color = glm::vec3(0.1f, 0.2f, 0.9f), material.roughness = 0.25f, material.alpha = 0.5f;
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

}  // namespace
}  // namespace lambent::baker
