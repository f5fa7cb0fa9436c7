#include <iterator>
#include <set>

#include <gtest/gtest.h>

#include "assets/scenes.hpp"
#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"
#include "baker/import/gltf.hpp"
#include "baker/sweep/sweep.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

std::set<std::string> knobsOf(const SceneFacts& facts) {
  std::set<std::string> names;
  const auto settings = settingsOf(facts, Quality::Draft, {});
  if (!settings) return names;
  for (const Setting& setting : *settings) names.insert(std::string(setting.knob->name));
  return names;
}

// Returns the knobs that a sweep of the scene turns.
std::set<std::string> knobsOfScene(const assets::Scene& made) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "scene.glb";
  if (!assets::writeGlb(file, made)) return {};
  const auto scene = importScene(file);
  if (!scene) return {};
  const auto plan = planFor(*scene, {.quality = Quality::Draft});
  return plan ? knobsOf(factsOf(*plan)) : std::set<std::string>{};
}

TEST(Knobs, OfAnEffectAreTurnedForScenesThatHaveIt) {
  const std::set<std::string> of_effects = {"glossy-order", "volume-grid",  "neighborhood-grid",
                                            "light-probes", "capture-size", "capture-subsamples"};
  const auto ofEffects = [&](const assets::Scene& scene) {
    std::set<std::string> turned;
    std::ranges::set_intersection(knobsOfScene(scene), of_effects, std::inserter(turned, turned.begin()));
    return turned;
  };
  EXPECT_TRUE(knobsOfScene(assets::hello()).contains("rays"));
  EXPECT_TRUE(knobsOfScene(assets::hello()).contains("refine"));
  EXPECT_FALSE(knobsOf({.volumes = true}).contains("refine"));
  EXPECT_EQ(ofEffects(assets::hello()), std::set<std::string>{});
  const std::set<std::string> things_that_move = {"neighborhood-grid", "light-probes", "capture-size",
                                                  "capture-subsamples"};
  EXPECT_EQ(ofEffects(assets::playroom()), things_that_move);
  EXPECT_TRUE(ofEffects(assets::metals()).contains("glossy-order"));
  EXPECT_TRUE(ofEffects(assets::flight()).contains("volume-grid"));
}

TEST(Knobs, AllValuesOfAllKnobsAreUnderstoodByTheBake) {
  const SceneFacts all{true, true, true, true, true, true};
  for (const Quality quality : {Quality::Draft, Quality::Standard, Quality::High}) {
    const auto settings = settingsOf(all, quality, {});
    ASSERT_TRUE(settings) << settings.error().line();
    for (const Setting& setting : *settings) EXPECT_TRUE(checkOptions(setting.bake)) << setting.name();
  }
}

TEST(Knobs, AskedOnesComeWithTheValuesThatAreNamed) {
  const std::vector<std::string> asked = {"rays=128,300", "keys=off"};
  const auto settings = settingsOf({}, Quality::Draft, asked);
  ASSERT_TRUE(settings);
  ASSERT_EQ(settings->size(), 4u);
  EXPECT_EQ((*settings)[2].bake.rays, 300u);
  EXPECT_EQ((*settings)[2].command(), "lambent bake --quality draft --rays 300");
  EXPECT_EQ((*settings)[3].command(), "lambent-demo --keys off");
}

}  // namespace
}  // namespace lambent::baker
