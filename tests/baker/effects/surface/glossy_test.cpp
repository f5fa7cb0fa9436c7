// Tests what the plan says about glossy surfaces.
#include "baker/plan/effect_plan.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::grid;
using testing::sceneOf;

EffectChoice choiceOf(const Scene& scene) {
  return effectsNamed("glossy")->front().choose(scene, findRigidGroups(scene));
}

TEST(ChooseGlossy, LeavesMatteScenesAlone) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1)});
  EXPECT_FALSE(choiceOf(scene).baked);
  EXPECT_EQ(choiceOf(scene).reason, "every material is diffuse");
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].metallic = 1.0f;  // which nothing is made of
  EXPECT_FALSE(choiceOf(scene).baked);
}

TEST(ChooseGlossy, CountsWhatThereIsAndSaysWhatFiveBandsCannotCarry) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1), grid({2, 0, 0}, 1.0f, 1), grid({4, 0, 0}, 1.0f, 1)});
  gltf::Material& metal = testing::ownMaterial(scene, 1);
  metal.metallic = 1.0f;
  metal.roughness = 0.3f;
  metal.anisotropy = 0.5f;
  scene.materials[0].roughness = 0.8f;
  const EffectChoice choice = choiceOf(scene);
  EXPECT_TRUE(choice.baked);
  EXPECT_EQ(
      choice.reason,
      "3 draws are not diffuse (1 metallic, 2 dielectric, 1 anisotropic): 25 x 25 transfer matrices for "
      "any light and "
      "view; 1 draw with roughness below 0.5, down to 0.3, where order 5 carries 38 % of the "
      "highlight's energy");
}

TEST(ChooseGlossy, SaysHowLittleOfTheirHighlightsSmoothDielectricsWouldHaveByMatrices) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1), grid({2, 0, 0}, 1.0f, 1), grid({4, 0, 0}, 1.0f, 1)});
  testing::ownMaterial(scene, 1).roughness = 0.4f;
  scene.materials[0].roughness = 0.0f;
  EXPECT_TRUE(choiceOf(scene).baked) << "it makes the table";
  EXPECT_EQ(
      choiceOf(scene).reason,
      "3 draws of smooth dielectrics, of whose highlights order 5 carries 0 to 71 %: diffuse transfer and "
      "the prefiltered environment instead");
  scene.materials[1].metallic = 1.0f;
  EXPECT_EQ(
      choiceOf(scene).reason,
      "1 draw is not diffuse (1 metallic): 25 x 25 transfer matrices for any light and view; 1 draw with "
      "roughness below 0.5, down to 0.4, where order 5 carries 71 % of the highlight's energy; 2 draws of "
      "smooth dielectrics, of whose highlights order 5 carries 0 %: diffuse transfer and the prefiltered "
      "environment instead");
}

TEST(LobeEnergyShare, MatchesTheKnownValuesAndEndsAtOneAndNothing) {
  EXPECT_NEAR(lobeEnergyShare(0.5, 5), 0.918, 1e-3);
  EXPECT_NEAR(lobeEnergyShare(0.4, 5), 0.713, 1e-3);
  EXPECT_NEAR(lobeEnergyShare(0.3, 5), 0.379, 1e-3);
  EXPECT_GT(lobeEnergyShare(1.0, 5), 0.99);
  EXPECT_LT(lobeEnergyShare(0.0, 5), 1e-3);
  EXPECT_GE(lobeEnergyShare(0.0, 5), 0.0);
  EXPECT_GT(lobeEnergyShare(0.4, 6), lobeEnergyShare(0.4, 5));
}

}  // namespace
}  // namespace lambent::baker
