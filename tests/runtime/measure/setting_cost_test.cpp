// Tests the measured cost and error of settings, beside a frame that goes on unchanged.
#include <gtest/gtest.h>

#include "runtime/measure/measured_frame.hpp"
#include "tests/support/frame/live_stage.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {

using testing::BundleBuilder;
using testing::farthest;
using testing::LiveStage;
using SettingCostTest = testing::GpuTest;

namespace {

const spec::Light kSun = spec::SunLight{
    .azimuth_deg = 60, .elevation_deg = 35, .angle_deg = 8, .radiance = glm::vec3(30.0f, 25.0f, 20.0f)};

BundleBuilder ball() {
  return BundleBuilder(5).add({testing::sphereMesh(12, 24), {}});
}

// Measures a setting at each of the values.
std::vector<SettingPoint> sweep(LiveStage& stage, std::string_view setting, std::vector<double> values,
                                const MeasureOptions& options) {
  std::vector<SettingPoint> points;
  const SettingRow& row = *findSetting(setting);
  for (const double value : values) {
    FrameSettings settings = stage.frame->settings();
    EXPECT_TRUE(putSetting(row, settings, value));
    const auto cost = measureSetting({stage.world, stage.environment, stage.view()}, settings, row, options);
    if (cost) points.push_back(cost->now);
  }
  return points;
}

}  // namespace

TEST_F(SettingCostTest, ErrorsFallTowardsTheFinestValueWhichHasNone) {
  LiveStage stage(ball(), {kSun});
  const auto before = stage.picture();
  const std::vector<SettingPoint> points =
      sweep(stage, "order", {1.0, 2.0, 3.0, 5.0, 8.0}, {.size = {48, 48}, .repeats = 2});
  ASSERT_EQ(points.size(), 5u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(points[i].error, points[i + 1].error) << i;
  EXPECT_EQ(points[3].error, 0.0) << "the transfer has five bands";
  EXPECT_EQ(points[4].error, 0.0);
  for (const SettingPoint& point : points) {
    EXPECT_GT(point.cpu_ms, 0.0);
    const auto shade = std::ranges::find(point.passes, "shade", &gpu::PassTime::name);
    ASSERT_NE(shade, point.passes.end());
    EXPECT_GT(shade->counters.dispatches, 0u) << "all of it had to run";
  }
  EXPECT_EQ(farthest(stage.picture(), before), 0.0f) << "the frame beside goes on as before";
}

TEST_F(SettingCostTest, TheErrorIsThatOfTwoPicturesDrawnApart) {
  FrameSettings coarse;
  coarse.window = sh::Window::Off;
  coarse.order = 2;
  LiveStage stage(ball(), {kSun}, coarse);
  const auto cost = measureSetting({stage.world, stage.environment, stage.view()}, coarse,
                                   *findSetting("order"), {.size = {64, 64}, .repeats = 0});
  ASSERT_TRUE(cost) << cost.error().line();
  EXPECT_EQ(cost->now.value, 2.0);
  EXPECT_EQ(cost->finest.value, 8.0);
  EXPECT_EQ(cost->finest.error, 0.0);
  const auto now = stage.picture();
  stage.set("order", "8");
  const auto finest = stage.picture();
  const auto expected = relativeRms({64, 64, now}, {64, 64, finest});
  ASSERT_TRUE(expected);
  EXPECT_NEAR(cost->now.error, *expected, 1e-6);
  EXPECT_GT(cost->now.error, 0.05);
  EXPECT_FALSE(
      measureSetting({stage.world, stage.environment, stage.view()}, coarse, *findSetting("exposure")))
      << "no knob of accuracy";
}

// The environment decides the number of key lights, and the measurement must include that.
TEST_F(SettingCostTest, FewerKeyLightsAreMeasuredByLightThatIsPartedSo) {
  const spec::Light small = spec::SunLight{
      .azimuth_deg = 60, .elevation_deg = 35, .angle_deg = 0.5f, .radiance = glm::vec3(9000.0f)};
  LiveStage stage(ball(), {small});
  stage.environment.setMostKeys(16);
  const std::vector<SettingPoint> points =
      sweep(stage, "keys", {0.0, 1.0, 32.0}, {.size = {64, 64}, .repeats = 1});
  ASSERT_EQ(points.size(), 3u);
  EXPECT_GT(points[0].error, 0.005) << "five bands alone";
  EXPECT_EQ(points[1].error, 0.0) << "there is only one";
  EXPECT_EQ(points[2].error, 0.0);
  EXPECT_EQ(stage.environment.keys().size(), 1u) << "the one beside stays as it is";
}

}  // namespace lambent::frame
