// Tests which light is traced inside a group, on shapes of which it is known.
#include <gtest/gtest.h>

#include "baker/plan/effect_plan.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::icosphere;
using testing::sceneOf;

PlannedTransport planned(const Scene& scene) {
  return planTransport(scene, findRigidGroups(scene)).at(0);
}

TEST(PlannedTransport, TracesNothingOnConvexBodiesAndPlanes) {
  for (const auto& mesh :
       {icosphere({1, 2, 3}, 0.5f, 3), box({0, 0, 0}, {1, 2, 3}, 4), grid({0, 0, 0}, 2, 9)}) {
    const PlannedTransport of = planned(sceneOf({mesh}));
    EXPECT_FALSE(of.shadows) << of.shadows_reason;
    EXPECT_FALSE(of.bounces) << of.bounces_reason;
    EXPECT_LE(of.height, kLevel);
  }
}

TEST(PlannedTransport, TracesWhereOneSurfaceSeesAnother) {
  const auto floor = grid({0, 0, 0}, 2.0f, 2);
  // The last is a valley of one degree.
  for (const Scene& scene :
       {sceneOf({flipped(box({0, 0, 0}, {1, 1, 1}, 2))}), sceneOf({floor, icosphere({0, 1, 0}, 0.2f, 1)}),
        sceneOf({floor, testing::transformed(testing::turned(grid({1, 0, 0}, 2.0f, 2), 1.0f, {0, 0, 1}),
                                             glm::translate(glm::mat4(1.0f), {1.0f, 0.0f, 0.0f}))})}) {
    const PlannedTransport of = planned(scene);
    EXPECT_TRUE(of.shadows) << of.shadows_reason;
    EXPECT_TRUE(of.bounces) << of.bounces_reason;
  }
}

TEST(PlannedTransport, KnowsTheBacksOfDoubleSidedSurfaces) {
  Scene plane = sceneOf({grid({0, 0, 0}, 2.0f, 3)}), shell = sceneOf({box({0, 0, 0}, {1, 1, 1}, 1)});
  plane.materials[0].double_sided = shell.materials[0].double_sided = true;
  EXPECT_FALSE(planned(plane).shadows) << "neither side of a plane sees the other";
  EXPECT_TRUE(planned(shell).shadows) << "the inside of a box sees itself";
}

TEST(PlannedTransport, SeesThroughNodesThatMirror) {
  Scene scene = sceneOf({icosphere({0, 0, 0}, 0.5f, 2)});
  scene.nodes[0].parent_from_node = glm::scale(glm::mat4(1.0f), {-1, 2, 1});
  EXPECT_FALSE(planned(scene).shadows);
}

TEST(PlannedTransport, BouncesNothingBetweenBlackSurfaces) {
  Scene scene = sceneOf({grid({0, 0, 0}, 2.0f, 2), icosphere({0, 1, 0}, 0.2f, 1)});
  scene.materials[0].base_color = glm::vec4(0, 0, 0, 1);
  scene.materials[0].specular = 0.0f;
  EXPECT_TRUE(planned(scene).shadows);
  EXPECT_FALSE(planned(scene).bounces);
  EXPECT_EQ(planned(scene).most_reflected, 0.0);
  scene.materials[0].metallic = 1.0f;
  EXPECT_TRUE(planned(scene).bounces) << "a metal reflects more at grazing angles";
}

}  // namespace
}  // namespace lambent::baker
