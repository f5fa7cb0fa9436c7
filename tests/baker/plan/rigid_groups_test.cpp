#include "baker/plan/rigid_groups.hpp"

#include <gtest/gtest.h>

#include "baker/plan/smooth_dielectrics.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {

namespace {

using testing::grid;
using testing::sceneOf;

// Makes node 0 with children 1 and 2; each has a mesh.
Scene family() {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1), grid({0, 0, 0}, 1.0f, 1), grid({0, 0, 0}, 1.0f, 1)});
  scene.roots = {0};
  scene.nodes[0].children = {1, 2};
  scene.nodes[1].parent = scene.nodes[2].parent = 0;
  return scene;
}

TEST(RigidGroups, OfAStillSceneAreOne) {
  const auto groups = findRigidGroups(family());
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].root, -1);
  EXPECT_EQ(groups[0].draws.size(), 3u);
}

TEST(RigidGroups, MovableAndAnimatedNodesTakeTheirDescendantsAlong) {
  Scene scene = family();
  scene.nodes[0].movable = true;
  scene.nodes[0].name = "cart";
  scene.nodes[2].animated = true;
  const auto groups = findRigidGroups(scene);
  ASSERT_EQ(groups.size(), 2u);  // nothing is left for the static group
  EXPECT_EQ(groups[0].name, "cart");
  EXPECT_EQ(groups[0].draws.size(), 2u);
  EXPECT_EQ(groups[1].root, 2);
  EXPECT_EQ(groups[1].draws[0].node, 2u);
}

TEST(RigidGroups, FrameIsRotationAndPlaceWithoutScale) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1)});
  scene.nodes[0].movable = true;
  const glm::quat turn = glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, -1)));
  for (const glm::vec3 scale : {glm::vec3(1.0f), glm::vec3(0.01f), glm::vec3(2, 3, 5), glm::vec3(-2, 2, 2)}) {
    scene.nodes[0].parent_from_node = glm::translate(glm::mat4(1.0f), {4, 5, 6}) * glm::mat4_cast(turn) *
                                      glm::scale(glm::mat4(1.0f), scale);
    const auto group = findRigidGroups(scene).at(0);
    EXPECT_EQ(group.rest_translation, glm::vec3(4, 5, 6));
    // What the frame leaves over is stretch alone (and the mirror): a symmetric matrix.
    const glm::mat3 left(group.draws[0].group_from_mesh);
    EXPECT_NEAR(glm::length(group.rest_rotation), 1.0f, 1e-6f);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(left[i][j], left[j][i], 1e-5f * std::abs(scale.y));
    EXPECT_NEAR(std::abs(glm::determinant(left)), std::abs(scale.x * scale.y * scale.z),
                1e-5f * std::abs(scale.x * scale.y * scale.z));
  }
}

TEST(RigidGroups, KeepTheirGeometryToTheLastBitWhileTheyMoveAsAWhole) {
  Scene scene = family();
  scene.nodes[0].movable = true;
  scene.nodes[1].parent_from_node = glm::translate(glm::mat4(1.0f), {0.1f, 0.7f, -0.3f}) *
                                    glm::mat4_cast(glm::angleAxis(0.3f, glm::vec3(0, 1, 0)));
  scene.nodes[2].parent_from_node = glm::scale(glm::mat4(1.0f), glm::vec3(0.37f, 1.1f, 2.9f));
  const auto stand = [&](glm::vec3 place, float angle, glm::vec3 scale) {
    const glm::quat turn = glm::angleAxis(angle, glm::normalize(glm::vec3(1, 2, -1)));
    scene.nodes[0].parent_from_node =
        glm::translate(glm::mat4(1.0f), place) * glm::mat4_cast(turn) * glm::scale(glm::mat4(1.0f), scale);
    return findRigidGroups(scene).at(0).draws;
  };
  for (const glm::vec3 scale : {glm::vec3(1.0f), glm::vec3(0.3f)}) {
    const auto here = stand({0, 0, 0}, 0.0f, scale);
    for (const auto& there : {stand({123.4f, -0.001f, 7}, 0.0f, scale), stand({0, 1, 0}, 2.1f, scale),
                              stand({-3, 5, 1e4f}, -0.4f, scale)})
      for (std::size_t d = 0; d < here.size(); ++d)
        EXPECT_EQ(here[d].group_from_mesh, there[d].group_from_mesh) << d;
  }
}

TEST(RigidGroups, AZeroScaleIsNotANan) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1)});
  scene.nodes[0].movable = true;
  scene.nodes[0].parent_from_node = glm::scale(glm::mat4(1.0f), glm::vec3(0.0f));
  const auto group = findRigidGroups(scene).at(0);
  EXPECT_EQ(group.rest_rotation, glm::quat(1, 0, 0, 0));
}

// Tests which surfaces go without matrices, and how much of the light they send on.

gltf::Material dielectric(float roughness) {
  gltf::Material material;
  material.metallic = 0.0f;
  material.roughness = roughness;
  return material;
}

TEST(SmoothDielectrics, AreThoseOfWhoseHighlightsFiveBandsCarryLessThanNineTenths) {
  EXPECT_TRUE(isSmoothDielectric(dielectric(0.0f)));
  EXPECT_TRUE(isSmoothDielectric(dielectric(0.45f)));
  EXPECT_FALSE(isSmoothDielectric(dielectric(0.5f))) << "91.8 %";
  EXPECT_TRUE(hasMatrices(dielectric(0.5f)));
  EXPECT_FALSE(hasMatrices(dielectric(0.45f)));
  EXPECT_FALSE(hasMatrices(dielectric(1.0f))) << "a diffuse surface";
  EXPECT_FALSE(isSmoothDielectric(dielectric(1.0f)));
}

TEST(SmoothDielectrics, AreNoMetalsAndHaveNoDirectionNoTexturesOfTheLayerAndLittleReflection) {
  gltf::Material material = dielectric(0.2f);
  material.metallic_roughness_texture.texture = 0;
  EXPECT_TRUE(isSmoothDielectric(material)) << "a texture makes it only smoother";
  const auto other = [&](auto change) {
    gltf::Material changed = dielectric(0.2f);
    change(changed);
    EXPECT_FALSE(isSmoothDielectric(changed));
    EXPECT_TRUE(hasMatrices(changed));
  };
  other([](gltf::Material& m) { m.metallic = 0.5f; });
  other([](gltf::Material& m) { m.anisotropy = 0.5f; });
  other([](gltf::Material& m) { m.brdf = 0; });
  other([](gltf::Material& m) { m.specular_texture.texture = 0; });
  other([](gltf::Material& m) { m.specular_color_texture.texture = 0; });
  other([](gltf::Material& m) { m.ior = 2.4f; });
}

TEST(SmoothDielectrics, SendOnAllLightIfTheirBaseIsWhiteAndWhatTheLayerReflectsIfItIsBlack) {
  const glm::vec3 layer = meanSpecularAlbedo(dielectric(0.2f));
  EXPECT_NEAR(layer.r, 0.04f + 0.96f / 21.0f, 1e-5f) << "the mean of Schlick's Fresnel term";
  EXPECT_NEAR(albedoUnderLayer(glm::vec3(1.0f), layer).g, 1.0f, 1e-6f);
  EXPECT_EQ(albedoUnderLayer(glm::vec3(0.0f), layer), layer);
  EXPECT_EQ(albedoUnderLayer(glm::vec3(0.3f), glm::vec3(0.0f)), glm::vec3(0.3f));
}

}  // namespace

}  // namespace lambent::baker
