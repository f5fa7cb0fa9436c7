#include "baker/plan/group_lights.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::grid;
using testing::sceneOf;

// Makes two floors, the second of an emissive material, and a point light.
Scene lampScene() {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1), grid({0, 1, 0}, 1.0f, 1)});
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emissive = {1.0f, 2.0f, 3.0f};
  scene.meshes[1].primitives[0].material = 1;
  gltf::Node lamp;
  lamp.light = 0;
  lamp.parent_from_node = glm::translate(glm::mat4(1.0f), {0, 5, 0});
  scene.nodes.push_back(lamp);
  scene.roots.push_back(2);
  gltf::Light light;
  light.color = {1.0f, 0.5f, 0.25f}, light.intensity = 8.0f;
  scene.lights.push_back(light);
  return scene;
}

TEST(GroupLights, AreEmissiveMaterialsAndThenPunctualLightsAtTheirStrengthInTheFile) {
  const Scene scene = lampScene();
  const auto lights = findGroupLights(scene, findRigidGroups(scene).at(0));
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[0].kind, PlannedLight::Kind::Material);
  EXPECT_EQ(lights[0].index, 1u);
  EXPECT_EQ(lights[0].color, glm::vec3(1, 2, 3));
  EXPECT_EQ(lights[1].kind, PlannedLight::Kind::Node);
  EXPECT_EQ(lights[1].index, 2u);
  EXPECT_EQ(lights[1].color, glm::vec3(8, 4, 2));
  EXPECT_EQ(glm::vec3(lights[1].group_from_node[3]), glm::vec3(0, 5, 0));
}

TEST(GroupLights, BelongToTheGroupThatTheyMoveWith) {
  Scene scene = lampScene();
  scene.nodes[1].movable = true;  // the emissive floor goes, the point light under it goes along
  scene.nodes[1].children = {2};
  scene.nodes[2].parent = 1;
  scene.roots = {0, 1};
  const auto groups = findRigidGroups(scene);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_TRUE(findGroupLights(scene, groups[0]).empty());
  EXPECT_EQ(findGroupLights(scene, groups[1]).size(), 2u);
  EXPECT_EQ(groupRootOf(scene, 2), groups[1].root);
}

TEST(GroupLights, ThatMoveWithNoSurfaceBelongToNone) {
  Scene scene = lampScene();
  scene.nodes[2].movable = true;
  const auto groups = findRigidGroups(scene);
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(findGroupLights(scene, groups[0]).size(), 1u);
  EXPECT_EQ(groupRootOf(scene, 2), 2);
}

TEST(GroupLights, AreNotMadeOfWhatIsDarkUnlitOrBlended) {
  Scene scene = lampScene();
  scene.lights[0].intensity = 0.0f;
  const auto count = [&] { return findGroupLights(scene, findRigidGroups(scene).at(0)).size(); };
  EXPECT_EQ(count(), 1u);
  scene.materials[1].unlit = true;
  EXPECT_EQ(count(), 0u);
  scene.materials[1].unlit = false;
  scene.materials[1].alpha_mode = gltf::AlphaMode::Blend;
  EXPECT_EQ(count(), 0u);
}

}  // namespace
}  // namespace lambent::baker
