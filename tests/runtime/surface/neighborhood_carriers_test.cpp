// Tests that each pair of bodies uses one carrier, grid or capture, and that nothing pops when it changes.
#include "runtime/light_plan/light_plan.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/neighborhood_checks.hpp"

namespace lambent::frame {

TEST_F(NeighborhoodFrame, EachPairHasOneCarrier) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f})};
  scene.bodies[0].sphere_radius = 1.0f;
  scene.receivers.push_back(floorOf(1.0f));
  scene.receivers[1].name = "far";
  scene.receivers[1].place = {9.0f, 0.0f, 0.0f};
  NeighborhoodStage stage(scene, {kSun, kWhite});
  stage.picture();
  const auto pairs = [&] { return stage.frame->counts()["neighborhood_pairs"]; };
  // Groups: the floor, the far one, the body.
  EXPECT_EQ(pairs(), 1u) << "the far one is beyond the grid and has the body by capture";
  EXPECT_EQ(stage.frame->counts()["light_probes"], 3u);
  stage.edit("body").translation.x = 7.0f;
  stage.picture();
  EXPECT_EQ(pairs(), 2u);
  // When the body leaves, the floor's light is that of the sky again.
  const glm::vec3 open = openLight(stage.environment);
  stage.half = 1.0f;
  stage.edit("body").translation = {20.0f, 1.5f, 0.0f};
  const spec::RgbaImage image = stage.picture();
  EXPECT_EQ(pairs(), 0u);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.texels[0][c], open[c], 0.02f * open[c]);
}

TEST_F(NeighborhoodFrame, ABodyIsEitherCapturedOrAroundNeverBoth) {
  // The floor's light probe is in its middle, right below the sphere: with captures, the whole floor darkens.
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, kFine, kFineHalf)};
  std::vector<spec::RgbaImage> images;
  for (const float proxy : {0.0f, 1.0f})
    for (const bool neighborhoods : {true, false}) {
      scene.bodies[0].sphere_radius = proxy;
      NeighborhoodStage stage(scene, {kSun, kWhite}, neighborhoods);
      images.push_back(stage.picture());
    }
  EXPECT_LT(worstDifference(images[0], images[2]), 1e-4) << "its proxy makes no difference";
  EXPECT_GT(worstDifference(images[1], images[3]), 0.5) << "but for captures";
  const double edge_by_grid = images[2].texels[0].r, edge_by_capture = images[3].texels[0].r;
  EXPECT_GT(edge_by_grid, 1.1 * edge_by_capture);
}

TEST_F(NeighborhoodFrame, NothingPopsWhereCarriersChange) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(0.3f)};
  scene.receivers[0].place = {6.0f, 0.0f, 0.0f};
  // The sun shines along the sphere's path: with captures, the floor behind the sphere loses it.
  const spec::Light low_sun =
      spec::SunLight{.azimuth_deg = -90, .elevation_deg = 20, .angle_deg = 3, .radiance = glm::vec3(300.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, glm::uvec3(21), glm::vec3(4.0f))};
  scene.bodies[0].sphere_radius = 1.0f;
  NeighborhoodStage stage(scene, {low_sun, kWhite});
  stage.half = 8.0f;
  stage.picture();
  float before = -1.0f, largest = 0.0f, open = openLight(stage.environment).r;
  std::vector<std::uint64_t> pairs;
  for (int i = 0; i <= 60; ++i) {
    const float x = 5.5f - 0.05f * static_cast<float>(i);
    stage.edit("floor").translation.x = x;
    stage.render();
    pairs.push_back(stage.frame->counts()["neighborhood_pairs"]);
    const auto column = static_cast<std::uint32_t>((x / 8.0f + 1.0f) / 2.0f * NeighborhoodStage::kSide);
    const spec::RgbaImage image = stage.frame->readLinear();
    const float now = image.texels[31 * NeighborhoodStage::kSide + column].r;
    if (before >= 0.0f) largest = testing::larger(largest, std::abs(now - before));
    before = now;
  }
  EXPECT_EQ(pairs.front(), 0u);
  EXPECT_EQ(pairs.back(), 1u);
  EXPECT_LT(largest, 0.1f * open) << "without the fade it is 0.2";
}

TEST_F(NeighborhoodFrame, CarriersStayForAPointsDistance) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(1.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f})};  // its grid ends 4 m away, a point's distance is 1/3 m
  NeighborhoodStage stage(scene, {kWhite});
  const auto pairsAt = [&](float x) {
    stage.edit("body").translation.x = x;
    stage.picture();
    return stage.frame->counts()["neighborhood_pairs"];
  };
  EXPECT_EQ(pairsAt(5.4f), 0u);
  EXPECT_EQ(pairsAt(5.1f), 0u);
  EXPECT_EQ(pairsAt(4.9f), 1u);
  EXPECT_EQ(pairsAt(5.1f), 1u) << "still";
  EXPECT_EQ(pairsAt(5.4f), 0u);
}

TEST_F(NeighborhoodFrame, AVolumesGridActsOnTheGroupThatItStandsWithin) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, kFine, kFineHalf)};
  scene.bodies[0].volume = true;
  scene.bodies[0].within = 0;
  NeighborhoodStage stage(scene, {kSun, kWhite});
  const spec::RgbaImage image = stage.picture();
  EXPECT_LT(
      worst(stage, image, 2.5f, ideal(stage.environment, {{0.0f, 1.5f, 0.0f}}), openLight(stage.environment)),
      0.015);
  const LightPlan lit = makeLightPlan(stage.world, 1.0f);
  EXPECT_TRUE(lit.groups[1].left_out.empty()) << "the floor has no proxy";
}

// Tests changes, while bodies are shown, of how light goes between them.

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
