#include "baker/plan/effect_plan.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "baker/effects/effect_list.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::grid;
using testing::sceneOf;

bool leavesOut(const Scene& scene, const std::string& words,
               std::span<const EffectEntry> effects = effectList()) {
  const EffectPlan plan = makePlan(scene, effects);
  return std::any_of(plan.left_out.begin(), plan.left_out.end(),
                     [&](const std::string& sentence) { return sentence.find(words) != std::string::npos; });
}

TEST(EffectPlan, BakesDiffuseTransferForSurfacesAndSaysWhy) {
  const EffectPlan plan = makePlan(sceneOf({grid({0, 0, 0}, 1.0f, 1)}), effectList());
  ASSERT_EQ(plan.effects.size(), effectList().size());
  EXPECT_EQ(plan.effects[0].effect, "diffuse");
  EXPECT_TRUE(plan.effects[0].baked);
  EXPECT_NE(plan.effects[0].reason.find("1 draw"), std::string::npos);
  EXPECT_EQ(plan.effects[1].effect, "glossy");
  for (std::size_t other = 1; other < plan.effects.size(); ++other) EXPECT_FALSE(plan.effects[other].baked);
  EXPECT_TRUE(plan.left_out.empty());
}

TEST(EffectPlan, SaysWhatTheBakeWillNotShow) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1), grid({0, 1, 0}, 1.0f, 1)});
  const auto diffuse_alone = effectList().first(1);
  EXPECT_FALSE(leavesOut(scene, "Metallic", diffuse_alone));
  scene.materials[0].metallic = 1.0f;
  EXPECT_TRUE(leavesOut(scene, "Metallic", diffuse_alone));
  EXPECT_FALSE(leavesOut(scene, "Metallic")) << "the glossy effect shows it";
  scene.materials[0].unlit = true;  // shows its colour whatever the light, gloss or no gloss
  EXPECT_FALSE(leavesOut(scene, "Metallic", diffuse_alone));
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
