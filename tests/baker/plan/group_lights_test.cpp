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

using testing::box;
using testing::flipped;
using testing::icosphere;
using testing::joined;

// Makes a floor and an emissive mesh of material 1.
Scene glowing(bundle::MeshData mesh) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1), std::move(mesh)});
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emissive = glm::vec3(5.0f);
  scene.meshes[1].primitives[0].material = 1;
  return scene;
}

std::vector<bundle::LampSphere> spheresIn(const Scene& scene) {
  return findLampSpheres(scene, findRigidGroups(scene).at(0), 1);
}

TEST(LampSpheres, AnIcosphereIsASphereOfItsArea) {
  const auto spheres = spheresIn(glowing(icosphere({1, 2, 3}, 0.1f, 3)));
  ASSERT_EQ(spheres.size(), 1u);
  EXPECT_LT(glm::distance(spheres[0].center, glm::vec3(1, 2, 3)), 1e-5f);
  // The chords of an icosphere of 1280 triangles take 0.7 % of the area.
  EXPECT_NEAR(spheres[0].radius_m, 0.1f, 5e-4f);
  EXPECT_LT(spheres[0].radius_m, 0.1f);
  EXPECT_NEAR(spheres[0].body_radius_m, 0.1f, 1e-6f);
}

TEST(LampSpheres, HaveSeamsThatDifferByRounding) {
  bundle::MeshData mesh = icosphere({0, 0, 0}, 0.1f, 2);
  bundle::MeshData apart = mesh;  // no triangle shares a corner with another
  apart.positions.clear();
  apart.indices.clear();
  for (const std::uint32_t index : mesh.indices) {
    const auto number = static_cast<std::uint32_t>(apart.positions.size());
    apart.indices.push_back(number);
    apart.positions.push_back(mesh.positions[index] + glm::vec3(number % 2 == 0 ? 1e-9f : 0.0f));
  }
  apart.normals.assign(apart.positions.size(), glm::vec3(0, 1, 0));
  EXPECT_EQ(spheresIn(glowing(apart)).size(), 1u);
}

TEST(LampSpheres, StandWhereTheirNodeStands) {
  Scene scene = glowing(icosphere({0, 0, 0}, 0.1f, 2));
  scene.nodes[1].parent_from_node =
      glm::scale(glm::translate(glm::mat4(1.0f), {4, 5, 6}), glm::vec3(2.0f, 2.0f, -2.0f));
  const auto spheres = spheresIn(scene);
  ASSERT_EQ(spheres.size(), 1u) << "mirrored, but it still emits outwards";
  EXPECT_LT(glm::distance(spheres[0].center, glm::vec3(4, 5, 6)), 1e-5f);
  EXPECT_NEAR(spheres[0].body_radius_m, 0.2f, 1e-6f);
}

TEST(LampSpheres, AreAsManyAsTheMaterialHasClosedPartsUpToFour) {
  bundle::MeshData mesh = icosphere({0, 0, 0}, 0.1f, 1);
  for (int k = 1; k < 4; ++k) {
    mesh = joined(std::move(mesh), icosphere({static_cast<float>(k), 0, 0}, 0.1f, 1));
    EXPECT_EQ(spheresIn(glowing(mesh)).size(), static_cast<std::size_t>(k + 1));
  }
  mesh = joined(std::move(mesh), icosphere({4, 0, 0}, 0.1f, 1));
  EXPECT_TRUE(spheresIn(glowing(mesh)).empty());
}

TEST(LampSpheres, AreNotMadeOfAnythingElse) {
  EXPECT_TRUE(spheresIn(glowing(grid({0, 1, 0}, 1.0f, 4))).empty()) << "a panel";
  EXPECT_TRUE(spheresIn(glowing(box({0, 1, 0}, glm::vec3(1.0f), 2))).empty()) << "a box";
  EXPECT_TRUE(spheresIn(glowing(flipped(icosphere({0, 1, 0}, 1.0f, 2)))).empty()) << "it emits inwards";
  bundle::MeshData holed = icosphere({0, 1, 0}, 1.0f, 2);
  holed.indices.resize(holed.indices.size() - 3);
  EXPECT_TRUE(spheresIn(glowing(holed)).empty()) << "it is open";
  EXPECT_TRUE(spheresIn(glowing(joined(icosphere({0, 1, 0}, 1.0f, 2), grid({0, 5, 0}, 1.0f, 1)))).empty())
      << "not all of it is a sphere";
  bundle::MeshData flat = icosphere({0, 0, 0}, 1.0f, 2);
  for (glm::vec3& position : flat.positions) position.y *= 0.5f;
  EXPECT_TRUE(spheresIn(glowing(flat)).empty()) << "an ellipsoid";
  Scene textured = glowing(icosphere({0, 1, 0}, 1.0f, 2));
  textured.materials[1].emissive_texture.texture = 0;
  EXPECT_TRUE(spheresIn(textured).empty()) << "it does not emit evenly";
}

}  // namespace

}  // namespace lambent::baker
