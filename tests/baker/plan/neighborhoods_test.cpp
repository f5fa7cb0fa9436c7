// Tests which bodies get a neighborhood in the plan, and for which receivers.
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

struct PlannedBodies {
  std::vector<RigidGroup> groups;
  std::vector<PlannedNeighborhood> plans;

  std::size_t indexOf(const std::string& name) const {
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (groups[g].name == name) return g;
    ADD_FAILURE() << "no group " << name;
    return 0;
  }
  const PlannedNeighborhood& of(const std::string& name) const { return plans[indexOf(name)]; }
};

PlannedBodies planBodies(const Scene& scene) {
  PlannedBodies out{findRigidGroups(scene), {}};
  out.plans = planNeighborhoods(scene, out.groups);
  return out;
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
  const PlannedBodies planned = planBodies(ballsOver(1, 0.5f));
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
  scene.nodes[1].animated = true;
  scene.nodes[1].trs = gltf::Trs{.translation = {0, 3, 0}};
  scene.animations = {{"way",
                       {{.node = 1,
                         .path = gltf::AnimationChannel::Path::Translation,
                         .times_s = {0.0f, 2.0f},
                         .values = {0, 3, 0, 0, 0.5f, 0}}}}};
  const PlannedNeighborhood ball = planBodies(scene).of("ball 0");
  EXPECT_TRUE(ball.baked);
  EXPECT_NEAR(ball.receivers_min.y, -3.0f, 1e-3f);
  EXPECT_NEAR(ball.receivers_max.y, -0.5f, 1e-3f);
}

TEST(NeighborhoodPlans, AreForBodiesThatCanBeMovedByHandWhereverTheyStand) {
  const PlannedBodies planned = planBodies(ballsOver(1, 3.0f));
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
  const PlannedBodies planned = planBodies(scene);
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
    const PlannedBodies planned = planBodies(scene);
    EXPECT_EQ(planned.of("cloud").baked, height < 10.0f);
    EXPECT_EQ(planned.of("cloud").carries(planned.indexOf("static")), height < 10.0f);
  }
}

TEST(NeighborhoodPlans, MakeLightProbesForTheBodyNeedless) {
  const Scene scene = ballsOver(1, 0.5f);
  const PlannedBodies planned = planBodies(scene);
  const std::size_t floor = planned.indexOf("static");
  EXPECT_EQ(planLightProbes(scene, planned.groups)[floor].count.count, 32u);
  EXPECT_EQ(planLightProbes(scene, planned.groups, planned.plans)[floor].count.count, 1u);
}

}  // namespace
}  // namespace lambent::baker
