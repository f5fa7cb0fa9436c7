#include "baker/plan/effect_plan.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "baker/effects/effect_list.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::grid;
using testing::sceneOf;

bool leavesOut(const Scene& scene, const std::string& words) {
  const EffectPlan plan = makePlan(scene, effectList());
  return std::any_of(plan.left_out.begin(), plan.left_out.end(),
                     [&](const std::string& sentence) { return sentence.find(words) != std::string::npos; });
}

TEST(EffectPlan, BakesDiffuseTransferForSurfacesAndSaysWhy) {
  const EffectPlan plan = makePlan(sceneOf({grid({0, 0, 0}, 1.0f, 1)}), effectList());
  ASSERT_EQ(plan.effects.size(), 1u);
  EXPECT_EQ(plan.effects[0].effect, "diffuse");
  EXPECT_TRUE(plan.effects[0].baked);
  EXPECT_NE(plan.effects[0].reason.find("1 draw"), std::string::npos);
  EXPECT_TRUE(plan.left_out.empty());
}

TEST(EffectPlan, OfNothingBakesNothing) {
  const EffectPlan plan = makePlan(Scene{}, effectList());
  EXPECT_FALSE(plan.effects[0].baked);
}

TEST(EffectPlan, SaysWhatTheBakeWillNotShow) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1), grid({0, 1, 0}, 1.0f, 1)});
  EXPECT_FALSE(leavesOut(scene, "Metallic"));
  scene.materials[0].metallic = 1.0f;
  EXPECT_TRUE(leavesOut(scene, "Metallic"));
  scene.materials[0].unlit = true;  // shows its colour whatever the light, gloss or no gloss
  EXPECT_FALSE(leavesOut(scene, "Metallic"));
  EXPECT_FALSE(leavesOut(scene, "Rigid groups"));
  scene.nodes[1].animated = true;
  EXPECT_TRUE(leavesOut(scene, "Animations"));
  EXPECT_TRUE(leavesOut(scene, "Rigid groups"));
}

TEST(EffectPlan, NamesLightsThatMoveWithoutASurface) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1)});
  scene.lights.resize(1);
  scene.nodes.resize(3);
  scene.nodes[1].children = {2};
  scene.nodes[2].parent = 1;
  scene.nodes[2].name = "torch";
  scene.nodes[2].light = 0;
  scene.roots.push_back(1);
  EXPECT_FALSE(leavesOut(scene, "torch"));  // stands still, as the floor does
  scene.nodes[1].movable = true;
  EXPECT_TRUE(leavesOut(scene, "The light of torch shines on nothing"));
  scene.nodes[1].mesh = 0;  // and now it is carried
  EXPECT_FALSE(leavesOut(scene, "torch"));
}

TEST(EffectPlan, WarnsAboutAnimationsThatStretchButNotThoseThatGrow) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1)});
  scene.nodes[0].name = "jelly";
  scene.nodes[0].animated = true;
  scene.nodes[0].trs = gltf::Trs{.scale = {1, 2, 3}};
  gltf::AnimationChannel channel{
      .path = gltf::AnimationChannel::Path::Scale, .times_s = {0, 1}, .values = {1, 2, 3, 2, 4, 6}};
  scene.animations = {{"wobble", {channel}}};
  EXPECT_FALSE(leavesOut(scene, "stretches"));
  scene.animations[0].channels[0].values[5] = 7.0f;
  EXPECT_TRUE(leavesOut(scene, "stretches jelly"));
}

}  // namespace
}  // namespace lambent::baker
