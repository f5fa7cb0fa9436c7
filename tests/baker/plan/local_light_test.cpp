#include "baker/plan/local_light.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::grid;
using testing::icosphere;
using testing::sceneOf;

struct PlannedLight {
  std::vector<RigidGroup> groups;
  std::vector<PlannedLightProbes> samples;

  const PlannedLightProbes& of(const std::string& name) const {
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (groups[g].name == name) return samples[g];
    ADD_FAILURE() << "no group " << name;
    return samples.front();
  }
};

PlannedLight planLight(const Scene& scene) {
  PlannedLight out{findRigidGroups(scene), {}};
  out.samples = planLightProbes(scene, out.groups);
  return out;
}

// Makes a ball of radius 1 (half its box's diagonal: √3) and a point light that moves by itself.
Scene ballAndLamp(float distance) {
  Scene scene = sceneOf({icosphere({0, 0, 0}, 1.0f, 3)});
  scene.nodes[0].name = "ball";
  gltf::Node lamp;
  lamp.name = "torch";
  lamp.light = 0;
  lamp.movable = true;
  lamp.parent_from_node = glm::translate(glm::mat4(1.0f), {0, distance, 0});
  scene.nodes.push_back(lamp);
  scene.roots.push_back(1);
  scene.lights.resize(1);
  return scene;
}

void move(Scene& scene, std::uint32_t node, glm::vec3 from, glm::vec3 to) {
  scene.nodes[node].animated = true;
  scene.nodes[node].trs = gltf::Trs{.translation = from};
  scene.nodes[node].parent_from_node = glm::translate(glm::mat4(1.0f), from);
  scene.animations = {{"way",
                       {{.node = node,
                         .path = gltf::AnimationChannel::Path::Translation,
                         .times_s = {0.0f, 2.0f},
                         .values = {from.x, from.y, from.z, to.x, to.y, to.z}}}}};
}

TEST(LightProbeCounts, AreOneForOneGroupWithNothingOutside) {
  Scene scene = sceneOf({icosphere({0, 0, 0}, 1.0f, 2)});
  EXPECT_EQ(planLight(scene).samples.at(0).count.count, 1u);
  EXPECT_NE(planLight(scene).samples.at(0).reason.find("far away"), std::string::npos);
  // Its own lights are in its transfer.
  scene.materials[0].emissive = glm::vec3(5.0f);
  scene.lights.resize(1);
  scene.nodes[0].light = 0;
  EXPECT_EQ(planLight(scene).samples.at(0).count.count, 1u);
}

TEST(LightProbeCounts, RiseWithSizeOverDistanceOfALamp) {
  const float half = std::sqrt(3.0f);
  for (const auto& [ratio, count] :
       {std::pair{0.04f, 1u}, {0.12f, 4u}, {0.2f, 8u}, {0.4f, 16u}, {0.6f, 32u}, {5.0f, 32u}})
    EXPECT_EQ(planLight(ballAndLamp(half / ratio)).samples.at(0).count.count, count) << ratio;
  EXPECT_NE(planLight(ballAndLamp(half / 0.6f)).samples[0].reason.find("the light of torch is up to 0.60"),
            std::string::npos)
      << planLight(ballAndLamp(half / 0.6f)).samples[0].reason;
}

TEST(LightProbeCounts, IgnoreLampsThatAreDarkDirectionalOrOutOfRange) {
  Scene scene = ballAndLamp(2.0f);
  scene.lights[0].type = gltf::Light::Type::Directional;
  EXPECT_EQ(planLight(scene).samples[0].count.count, 1u);
  scene = ballAndLamp(2.0f);
  scene.lights[0].intensity = 0.0f;
  EXPECT_EQ(planLight(scene).samples[0].count.count, 1u);
  scene = ballAndLamp(10.0f);
  EXPECT_EQ(planLight(scene).samples[0].count.count, 8u);
  scene.lights[0].range_m = 5.0f;
  EXPECT_EQ(planLight(scene).samples[0].count.count, 1u);
}

TEST(LightProbeCounts, LookAlongTheWholeWayOfAnAnimation) {
  Scene scene = ballAndLamp(50.0f);
  EXPECT_EQ(planLight(scene).samples[0].count.count, 1u);
  move(scene, 1, {0, 50, 0}, {0, 4, 0});
  EXPECT_EQ(planLight(scene).samples[0].count.count, 16u);
}

TEST(LightProbeCounts, CountSurfacesOfOthersThatGiveOffLightAsLamps) {
  Scene scene = sceneOf({icosphere({0, 0, 0}, 1.0f, 3), grid({0, 3, 0}, 4.0f, 1)});
  scene.nodes[0].name = "ball";
  scene.nodes[0].movable = true;
  scene.materials.push_back(scene.materials[0]);
  scene.meshes[1].primitives[0].material = 1;
  EXPECT_EQ(planLight(scene).of("ball").count.count, 4u) << "it only reflects";
  scene.materials[1].emissive = glm::vec3(1.0f);
  EXPECT_EQ(planLight(scene).of("ball").count.count, 32u) << "√3 / 3";
}

TEST(LightProbeCounts, AreMostOfAFloorThatBodiesMoveOver) {
  Scene scene = sceneOf({grid({0, 0, 0}, 20.0f, 4), icosphere({0, 0, 0}, 1.0f, 3)});
  scene.nodes[1].name = "ball";
  move(scene, 1, {-5, 1, 0}, {5, 1, 0});
  EXPECT_EQ(planLight(scene).of("static").count.count, kMostLightProbes);
  EXPECT_EQ(planLight(scene).of("static").reason, "ball can come within its bounds");
  EXPECT_EQ(planLight(scene).of("ball").count.count, 4u);
  // High above it the ball is a small thing, and the floor a far one.
  move(scene, 1, {-5, 400, 0}, {5, 400, 0});
  EXPECT_EQ(planLight(scene).of("static").count.count, 1u);
  EXPECT_EQ(planLight(scene).of("ball").count.count, 1u);
}

TEST(LightProbeCounts, OfAPointStayFinite) {
  Scene scene = ballAndLamp(0.0f);
  for (glm::vec3& p : scene.meshes[0].primitives[0].mesh.positions) p = glm::vec3(0.0f);
  EXPECT_EQ(planLight(scene).samples[0].count.count, 1u) << "no size, one place";
}

TEST(LightsInside, AreThoseWhoseWayMeetsAGroupsBounds) {
  Scene scene = ballAndLamp(50.0f);
  const auto sentences = [&] { return lightsInside(scene, findRigidGroups(scene)); };
  EXPECT_TRUE(sentences().empty());
  move(scene, 1, {0, 50, 0}, {0, 0.5f, 0});
  ASSERT_EQ(sentences().size(), 1u);
  EXPECT_EQ(sentences()[0],
            "The light of torch can stand among the surfaces of static: direct light per pixel by a shadow "
            "cube map, its bounces by patches.");
  // A light that is fixed to the group is baked.
  scene.animations.clear();
  scene.nodes[1].animated = scene.nodes[1].movable = false;
  scene.nodes[1].parent_from_node = glm::mat4(1.0f);
  EXPECT_TRUE(sentences().empty());
}

}  // namespace
}  // namespace lambent::baker
