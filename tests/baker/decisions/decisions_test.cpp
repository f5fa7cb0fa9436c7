// Tests that each scene is told the decision which is right for it, and why.
#include "baker/decisions/decisions.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "baker/bake/bake.hpp"
#include "baker/plan/counted.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::grid;
using testing::icosphere;
using testing::sceneOf;

// Returns the decisions about the only group of a scene.
GroupDecisions decided(const Scene& scene, const BakeOptions& options = {}) {
  const auto plan = planFor(scene, options);
  EXPECT_TRUE(plan);
  return decisionsOf({scene, options, *plan}).at(0);
}

const Decision& about(const std::vector<Decision>& decisions, const std::string& effect) {
  return *std::ranges::find(decisions, effect, &Decision::effect);
}

Scene ballOnFloor() {
  return sceneOf({grid({0, 0, 0}, 3.0f, 2), icosphere({0, 0.6f, 0}, 0.5f, 2)});
}

TEST(Decisions, LeaveShadowsAndBouncesOutOnAConvexBody) {
  const auto [group, primitives] = decided(sceneOf({icosphere({0, 0, 0}, 1.0f, 2)}));
  for (const char* effect : {"shadows", "interreflection", "refinement"})
    EXPECT_EQ(about(group, effect).choice, Choice::LeftOut) << effect;
  EXPECT_NE(about(group, "shadows").reason.find("no vertex"), std::string::npos);
  EXPECT_EQ(primitives.size(), 1u);
}

TEST(Decisions, LeaveOutTheBacksOfClosedBodies) {
  Scene scene = ballOnFloor();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].double_sided = true;
  const auto backOf = [&](std::size_t draw, const BakeOptions& options = {}) {
    return about(decided(scene, options).primitives[draw], "backs").choice;
  };
  scene.meshes[1].primitives[0].material = 1;
  EXPECT_EQ(backOf(0), Choice::Absent) << "the floor is single-sided";
  EXPECT_EQ(backOf(1), Choice::LeftOut);
  EXPECT_EQ(backOf(1, {.effects = "all"}), Choice::Baked);
  scene.meshes[0].primitives[0].material = 1;
  EXPECT_EQ(backOf(0), Choice::Baked) << "a floor is open";
}

TEST(Decisions, BakeWhatABallOnAFloorCallsFor) {
  const auto [group, primitives] = decided(ballOnFloor());
  for (const char* effect : {"shadows", "interreflection", "refinement"})
    EXPECT_EQ(about(group, effect).choice, Choice::Baked) << effect;
  for (const char* effect : {"lamps", "volume", "neighborhood"})
    EXPECT_EQ(about(group, effect).choice, Choice::Absent) << effect;
  EXPECT_EQ(primitives.size(), 2u);
}

TEST(Decisions, SayWhichCarrierAHighlightHas) {
  Scene scene = ballOnFloor();
  scene.materials.resize(2, scene.materials[0]);
  scene.materials[0].specular = 0.0f;
  scene.meshes[1].primitives[0].material = 1;
  const auto of_ball = [&] { return decided(scene).primitives.at(1); };
  scene.materials[1].metallic = 1.0f, scene.materials[1].roughness = 0.05f;
  auto mirror = of_ball();
  EXPECT_EQ(about(mirror, "matrices").choice, Choice::Baked);
  EXPECT_EQ(about(mirror, "mirrorPaths").choice, Choice::Baked);
  EXPECT_EQ(about(mirror, "specularLayer").choice, Choice::Absent);
  scene.materials[1].metallic = 0.0f, scene.materials[1].specular = 1.0f;
  auto lacquer = of_ball();
  EXPECT_EQ(about(lacquer, "matrices").choice, Choice::LeftOut);
  EXPECT_EQ(about(lacquer, "specularLayer").choice, Choice::Baked);
  EXPECT_EQ(about(lacquer, "mirrorPaths").choice, Choice::Absent);
  scene.materials[1].specular = 0.0f;
  EXPECT_EQ(about(of_ball(), "matrices").choice, Choice::Absent);
}

}  // namespace
}  // namespace lambent::baker
