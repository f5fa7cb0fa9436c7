#include "baker/plan/neighborhoods.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "baker/plan/local_light.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {

namespace {

using testing::grid;
using testing::icosphere;
using testing::sceneOf;

template <typename Plan>
struct Planned {
  std::vector<RigidGroup> groups;
  std::vector<Plan> plans;

  std::size_t indexOf(const std::string& name) const {
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (groups[g].name == name) return g;
    ADD_FAILURE() << "no group " << name;
    return 0;
  }
  const Plan& of(const std::string& name) const { return plans[indexOf(name)]; }
};

Planned<PlannedLightProbes> planLight(const Scene& scene) {
  const std::vector<RigidGroup> groups = findRigidGroups(scene);
  return {groups, planLightProbes(scene, groups)};
}

Planned<PlannedNeighborhood> planBodies(const Scene& scene) {
  const std::vector<RigidGroup> groups = findRigidGroups(scene);
  return {groups, planNeighborhoods(scene, groups)};
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
  EXPECT_EQ(planLight(scene).plans.at(0).count.count, 1u);
  EXPECT_NE(planLight(scene).plans.at(0).reason.find("far away"), std::string::npos);
  // Its own lights are in its transfer.
  scene.materials[0].emissive = glm::vec3(5.0f);
  scene.lights.resize(1);
  scene.nodes[0].light = 0;
  EXPECT_EQ(planLight(scene).plans.at(0).count.count, 1u);
}

TEST(LightProbeCounts, RiseWithSizeOverDistanceOfALamp) {
  const float half = std::sqrt(3.0f);
  for (const auto& [ratio, count] :
       {std::pair{0.04f, 1u}, {0.12f, 4u}, {0.2f, 8u}, {0.4f, 16u}, {0.6f, 32u}, {5.0f, 32u}})
    EXPECT_EQ(planLight(ballAndLamp(half / ratio)).plans.at(0).count.count, count) << ratio;
  EXPECT_NE(planLight(ballAndLamp(half / 0.6f)).plans[0].reason.find("the light of torch is up to 0.60"),
            std::string::npos)
      << planLight(ballAndLamp(half / 0.6f)).plans[0].reason;
}

TEST(LightProbeCounts, IgnoreLampsThatAreDarkDirectionalOrOutOfRange) {
  Scene scene = ballAndLamp(2.0f);
  scene.lights[0].type = gltf::Light::Type::Directional;
  EXPECT_EQ(planLight(scene).plans[0].count.count, 1u);
  scene = ballAndLamp(2.0f);
  scene.lights[0].intensity = 0.0f;
  EXPECT_EQ(planLight(scene).plans[0].count.count, 1u);
  scene = ballAndLamp(10.0f);
  EXPECT_EQ(planLight(scene).plans[0].count.count, 8u);
  scene.lights[0].range_m = 5.0f;
  EXPECT_EQ(planLight(scene).plans[0].count.count, 1u);
}

TEST(LightProbeCounts, LookAlongTheWholeWayOfAnAnimation) {
  Scene scene = ballAndLamp(50.0f);
  EXPECT_EQ(planLight(scene).plans[0].count.count, 1u);
  move(scene, 1, {0, 50, 0}, {0, 4, 0});
  EXPECT_EQ(planLight(scene).plans[0].count.count, 16u);
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
  EXPECT_EQ(planLight(scene).plans[0].count.count, 1u) << "no size, one place";
}

// Makes a floor of 20 m, and movable balls of radius 0.5 m at a height above it.
Scene ballsOver(int balls, float height, int cells = 40) {
  std::vector<bundle::MeshData> meshes = {grid({0, 0, 0}, 20.0f, cells)};
  for (int b = 0; b < balls; ++b) meshes.push_back(icosphere({0, 0, 0}, 0.5f, 1));
  Scene scene = sceneOf(meshes);
  for (int b = 0; b < balls; ++b) {
    gltf::Node& node = scene.nodes[static_cast<std::size_t>(b) + 1];
    node.name = "ball " + std::to_string(b);
    node.movable = true;
    node.parent_from_node =
        glm::translate(glm::mat4(1.0f), {-9.0f + 1.5f * static_cast<float>(b), height, 0.0f});
  }
  return scene;
}

// Makes bodies move by animation rather than by hand.
Scene rolling(Scene scene) {
  for (std::size_t n = 1; n < scene.nodes.size(); ++n) scene.nodes[n].animated = true;
  return scene;
}

TEST(NeighborhoodPlans, AreForBodiesOnGroupsOfMoreThanTwiceTheirSize) {
  const auto planned = planBodies(ballsOver(1, 0.5f));
  EXPECT_TRUE(planned.of("ball 0").baked);
  EXPECT_FALSE(planned.of("ball 0").asked);
  EXPECT_FALSE(planned.of("static").baked);
  EXPECT_TRUE(planned.of("ball 0").carries(planned.indexOf("static")));
  EXPECT_NE(planned.of("ball 0").reason.find("bounds of static"), std::string::npos);
  // Nothing requests a neighborhood high above.
  EXPECT_FALSE(planBodies(rolling(ballsOver(1, 3.0f))).of("ball 0").baked);
}

TEST(NeighborhoodPlans, KnowWhereReceiversStandInTheGroupsFrame) {
  const PlannedNeighborhood ball = planBodies(rolling(ballsOver(1, 0.5f))).of("ball 0");
  EXPECT_NEAR(ball.receivers_min.y, -0.5f, 1e-4f);
  EXPECT_NEAR(ball.receivers_max.y, -0.5f, 1e-4f);
  EXPECT_NEAR(ball.receivers_min.x, -1.0f, 1e-4f);  // the floor ends there
  EXPECT_GT(ball.receivers_max.x, 5.0f);
  EXPECT_LT(ball.receivers_max.x, 10.0f);  // and its reach here, although triangles go on
}

TEST(NeighborhoodPlans, KnowHowReceiversFaceInTheGroupsFrame) {
  // Area times y_k of the normal; y_2 is along z, y_1 along y.
  const auto along = [](const FacingArea& facing, std::size_t k) {
    return facing[k] / facing[0] / std::sqrt(3.0f);
  };
  Scene scene = rolling(ballsOver(1, 0.5f));
  const FacingArea up = planBodies(scene).of("ball 0").receivers_face;
  EXPECT_NEAR(along(up, 1), 1.0f, 1e-4f);
  EXPECT_NEAR(along(up, 2), 0.0f, 1e-4f);
  const PlannedNeighborhood ball = planBodies(scene).of("ball 0");
  const glm::vec3 reach = ball.receivers_max - ball.receivers_min;
  EXPECT_NEAR(up[0] / 0.28209479f, reach.x * reach.z, 1e-3f * reach.x * reach.z);
  // As the ball stands, the floor faces along its z.
  scene.nodes[1].parent_from_node =
      scene.nodes[1].parent_from_node * glm::rotate(glm::mat4(1.0f), 1.57079633f, glm::vec3(-1, 0, 0));
  const FacingArea turned = planBodies(scene).of("ball 0").receivers_face;
  EXPECT_NEAR(std::abs(along(turned, 2)), 1.0f, 1e-3f);
  EXPECT_NEAR(along(turned, 1), 0.0f, 1e-3f);
}

TEST(NeighborhoodPlans, FollowTheAnimation) {
  Scene scene = ballsOver(1, 3.0f);
  move(scene, 1, {0, 3, 0}, {0, 0.5f, 0});
  const PlannedNeighborhood ball = planBodies(scene).of("ball 0");
  EXPECT_TRUE(ball.baked);
  EXPECT_NEAR(ball.receivers_min.y, -3.0f, 1e-3f);
  EXPECT_NEAR(ball.receivers_max.y, -0.5f, 1e-3f);
}

TEST(NeighborhoodPlans, AreForBodiesThatCanBeMovedByHandWhereverTheyStand) {
  const auto planned = planBodies(ballsOver(1, 3.0f));
  const PlannedNeighborhood& ball = planned.of("ball 0");
  EXPECT_TRUE(ball.baked);
  EXPECT_TRUE(ball.by_hand);
  EXPECT_TRUE(ball.carries(planned.indexOf("static")));
  EXPECT_EQ(ball.reason, "it can be moved by hand onto static");
  EXPECT_TRUE(planBodies(ballsOver(1, 0.5f)).of("ball 0").by_hand) << "also where it stands on the floor";
  EXPECT_FALSE(planBodies(rolling(ballsOver(1, 0.5f))).of("ball 0").by_hand);
  for (std::size_t k = 1; k < ball.receivers_face.size(); ++k)
    EXPECT_EQ(ball.receivers_face[k], 0.0f) << "surfaces may face anywhere";
}

TEST(NeighborhoodPlans, AreNotForBodiesThatGiveOffLight) {
  Scene scene = ballsOver(1, 0.5f);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emissive = glm::vec3(1.0f);
  scene.meshes[1].primitives[0].material = 1;
  const auto planned = planBodies(scene);
  EXPECT_FALSE(planned.of("ball 0").baked);
  EXPECT_NE(planned.of("ball 0").reason.find("gives off light"), std::string::npos);
}

TEST(NeighborhoodPlans, TakeWhatTheSceneAsksFor) {
  Scene scene = ballsOver(9, 2.0f);
  scene.neighborhoods = {{.node = 2, .size = {16, 16, 4}, .extent = {8, 8, 2}}};
  const PlannedNeighborhood ball = planBodies(scene).of("ball 1");
  EXPECT_TRUE(ball.baked);
  EXPECT_TRUE(ball.asked);
  EXPECT_EQ(ball.size, glm::uvec3(16, 16, 4));
  EXPECT_EQ(ball.extent, glm::vec3(8, 8, 2));
  // A flat floor shadows nothing: three bands are enough.
  EXPECT_FALSE(ball.matrices);
}

TEST(NeighborhoodPlans, WantAllBandsForFineSurfacesThatShadowThemselves) {
  const auto hilly = [](int cells) {
    Scene scene = ballsOver(1, 3.0f, cells);
    for (glm::vec3& p : scene.meshes[0].primitives[0].mesh.positions)
      p.y = std::sin(1.3f * p.x) * std::cos(1.1f * p.z);
    scene.neighborhoods = {{.node = 1}};
    return scene;
  };
  EXPECT_TRUE(planBodies(hilly(120)).of("ball 0").matrices);
  EXPECT_FALSE(planBodies(hilly(20)).of("ball 0").matrices);
}

TEST(NeighborhoodPlans, AreForVolumesWithSurfacesInReach) {
  for (const float height : {3.0f, 300.0f}) {
    Scene scene = sceneOf({grid({0, 0, 0}, 20.0f, 4)});
    gltf::Node cloud;
    cloud.name = "cloud";
    cloud.parent_from_node = glm::translate(glm::mat4(1.0f), {0, height, 0});
    scene.nodes.push_back(cloud);
    scene.roots.push_back(1);
    scene.volumes.push_back(
        {.name = "fog", .node = 1, .size = glm::uvec3(2), .density = std::vector<float>(8, 1.0f)});
    const auto planned = planBodies(scene);
    EXPECT_EQ(planned.of("cloud").baked, height < 10.0f);
    EXPECT_EQ(planned.of("cloud").carries(planned.indexOf("static")), height < 10.0f);
  }
}

TEST(NeighborhoodPlans, MakeLightProbesForTheBodyNeedless) {
  const Scene scene = ballsOver(1, 0.5f);
  const auto planned = planBodies(scene);
  const std::size_t floor = planned.indexOf("static");
  EXPECT_EQ(planLightProbes(scene, planned.groups)[floor].count.count, 32u);
  EXPECT_EQ(planLightProbes(scene, planned.groups, planned.plans)[floor].count.count, 1u);
}

}  // namespace

}  // namespace lambent::baker
