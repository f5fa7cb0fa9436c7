// Tests changes, while bodies are shown, of how light goes between them.
#include "tests/support/frame/neighborhood_checks.hpp"

namespace lambent::frame {
namespace {

NeighborhoodScene sphereOverFloor(std::uint32_t floor_outputs) {
  NeighborhoodScene scene;
  BuiltReceiver floor = floorOf(8.0f);
  floor.outputs = floor_outputs;
  scene.receivers = {floor};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f})};
  scene.bodies[0].sphere_radius = 1.0f;  // captures see it, too
  return scene;
}

void set(NeighborhoodStage& stage, std::string_view name, std::string_view word) {
  FrameSettings settings = stage.frame->settings();
  ASSERT_TRUE(putSetting(settings, name, word));
  ASSERT_TRUE(stage.frame->setSettings(settings));
}

}  // namespace

using NeighborhoodLive = testing::GpuTest;

TEST_F(NeighborhoodLive, AnotherCarrierIsAsIfItHadBeenThereFromTheStart) {
  for (const std::uint32_t outputs : {1u, 9u}) {
    std::vector<glm::vec4> by_captures;
    {
      NeighborhoodStage off(sphereOverFloor(outputs), {kSun, kWhite}, /*neighborhoods=*/false);
      by_captures = off.picture().texels;
    }
    NeighborhoodStage stage(sphereOverFloor(outputs), {kSun, kWhite});
    const auto by_grids = stage.picture().texels;
    EXPECT_NE(by_grids, by_captures);
    set(stage, "neighborhoods", "off");
    EXPECT_EQ(stage.picture().texels, by_captures);
    EXPECT_FALSE(stage.counts("neighborhood")) << "no pass";
    set(stage, "neighborhoods", "on");
    EXPECT_EQ(stage.picture().texels, by_grids);
  }
}

TEST_F(NeighborhoodLive, WithoutCapturesNoBodyStandsInTheLight) {
  NeighborhoodStage stage(sphereOverFloor(1), {kWhite}, /*neighborhoods=*/false);
  const auto open = [&](const glm::vec3&) { return openLight(stage.environment); };
  const auto shadowed = stage.picture();
  EXPECT_GT(worst(stage, shadowed, 4.0f, open), 0.02);
  set(stage, "captures", "off");
  EXPECT_LT(worst(stage, stage.picture(), 4.0f, open), 2e-4);
  EXPECT_EQ(stage.frame->counts()["bodies"], 0u);
  set(stage, "captures", "on");
  EXPECT_EQ(stage.picture().texels, shadowed.texels);
}

TEST_F(NeighborhoodLive, CapturesOfAnotherSizeComeBackToTheSameLight) {
  NeighborhoodStage stage(sphereOverFloor(1), {kSun, kWhite}, /*neighborhoods=*/false);
  const auto before = stage.picture().texels;
  set(stage, "capture-size", "4");
  set(stage, "capture-subsamples", "1");
  EXPECT_NE(stage.picture().texels, before);
  EXPECT_EQ(stage.frame->counts()["light_probes_captured"], 0u) << "at rest";
  set(stage, "capture-size", "16");
  set(stage, "capture-subsamples", "16");
  EXPECT_EQ(stage.picture().texels, before);
}

}  // namespace lambent::frame
