// Tests overlays: their words, what they draw where, and that the rest of the picture stays the same.
#include "runtime/debug/overlays.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/frame/frame_parts.hpp"
#include "runtime/scene/instantiate.hpp"
#include "tests/support/frame/view_stage.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::linearOptions;
using testing::quadMesh;
using testing::sphereMesh;
using testing::ViewStage;

// Returns the pixels in which the two pictures differ.
std::vector<std::size_t> changes(const spec::RgbaImage& a, const spec::RgbaImage& b) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < a.texels.size(); ++i)
    if (a.texels[i] != b.texels[i]) found.push_back(i);
  return found;
}

}  // namespace

TEST(OverlayWords, AListNamesThem) {
  const auto both = parseOverlays("neighborhoods,lights");
  ASSERT_TRUE(both) << both.error().line();
  EXPECT_TRUE(both->neighborhoods && both->lights);
  EXPECT_FALSE(both->groups || both->volumes || both->light_probes);
  EXPECT_FALSE(parseOverlays("")->any());
  EXPECT_TRUE(parseOverlays("volumes")->volumes && parseOverlays("groups")->groups);
  EXPECT_TRUE(parseOverlays("light-probes")->light_probes && parseOverlays("keys")->keys);
  for (const char* wrong : {"light", "lights:x", "lights,,"}) {
    const auto options = parseOverlays(wrong);
    ASSERT_FALSE(options) << wrong;
    EXPECT_NE(options.error().hint.find("light-probes"), std::string::npos);
  }
}

using OverlayTest = testing::GpuTest;

TEST_F(OverlayTest, TheBallOfALightProbeHasConstantRadianceUnderConstantLight) {
  // The sample of the written bundle stands at the origin, in front of a quad, whichever way its group lies.
  const glm::vec3 radiance(0.25f, 0.5f, 2.0f);
  const glm::mat4 away = glm::translate(glm::mat4(1.0f), {0.0f, 0.0f, -0.5f});
  gltf::Material gray;
  gray.base_color = glm::vec4(0.2f, 0.2f, 0.2f, 1.0f);
  gray.metallic = 0.0f;
  ViewStage stage(BundleBuilder(5)
                      .add({quadMesh(), gray, away})
                      .groupRotation(glm::angleAxis(1.0f, glm::vec3(0, 0.6f, 0.8f))),
                  {spec::ConstantLight{.radiance = radiance}}, linearOptions());
  OverlayOptions shown;
  shown.light_probes = true;
  stage.frame->setOverlays(shown);
  stage.camera.fov_deg = 8.0f;
  stage.render();
  OverlayOptions nothing;
  const spec::RgbaImage with = stage.frame->readLinear();
  stage.frame->setOverlays(nothing);
  const spec::RgbaImage without = stage.picture();
  std::size_t ball = 0;
  for (const std::size_t i : changes(with, without)) {
    ASSERT_EQ(with.texels[i].a, without.texels[i].a) << "alpha is the scene's coverage";
    ++ball;
    ASSERT_LT(glm::distance(glm::vec3(with.texels[i]), radiance), 2e-3f);
  }
  EXPECT_GT(ball, 5u);
}

TEST_F(OverlayTest, WithoutOverlaysThePictureIsTheSameToTheBitAndThereIsNoPass) {
  for (const Output output : {Output::Linear, Output::Display}) {
    FrameOptions options;
    options.output = output;
    ViewStage stage(BundleBuilder().add({sphereMesh(12, 24), {}}),
                    {spec::ConstantLight{.radiance = glm::vec3(1.0f)}}, options);
    scene::addLights(stage.world.registry(), std::vector<spec::Light>{spec::SphereLight{
                                                 .position_ws = {0.0f, 0.0f, 1.2f}, .radius_m = 0.3f}});
    const auto picture = [&] {
      stage.render();
      return output == Output::Linear ? std::vector<std::uint8_t>{} : stage.frame->readDisplay().texels;
    };
    const auto linear = [&] {
      return output == Output::Linear ? stage.frame->readLinear().texels : std::vector<glm::vec4>{};
    };
    const auto before = picture();
    const auto before_linear = linear();
    OverlayOptions shown;
    shown.light_probes = shown.groups = shown.lights = true;
    stage.frame->setOverlays(shown);
    const bool same = picture() == before;
    EXPECT_FALSE(same && linear() == before_linear);
    stage.frame->setOverlays({});
    EXPECT_EQ(picture(), before);
    EXPECT_EQ(linear(), before_linear);
    stage.frame->timers().finish();
    for (const gpu::PassTime& pass : stage.frame->timers().latest()) EXPECT_NE(pass.name, "overlays");
  }
}

TEST_F(OverlayTest, LinesAreHiddenByWhatStandsBeforeThemButForATrace) {
  // One line runs from left to right behind the sphere, and one in front of it.
  const auto lineAt = [](float z) {
    OverlayOptions options;
    options.lines.push_back(
        {.from_ws = {-1.0f, 0.0f, z}, .to_ws = {1.0f, 0.0f, z}, .color = {1, 0, 0, 1}, .width_px = 3.0f});
    return options;
  };
  ViewStage stage(BundleBuilder().add({sphereMesh(12, 24), {}}),
                  {spec::ConstantLight{.radiance = glm::vec3(1.0f)}}, linearOptions());
  const spec::RgbaImage bare = stage.picture();
  const std::size_t middle = 32 * 64 + 32;
  stage.frame->setOverlays(lineAt(1.2f));
  const spec::RgbaImage before = stage.picture();
  EXPECT_LT(glm::distance(glm::vec3(before.texels[middle]), glm::vec3(1.0f, 0.0f, 0.0f)), 1e-3f);
  stage.frame->setOverlays(lineAt(-1.2f));
  const spec::RgbaImage behind = stage.picture();
  EXPECT_NE(behind.texels[middle], bare.texels[middle]);
  EXPECT_GT(behind.texels[middle].g, 0.6f) << "mostly the white sphere";
  // A line that reaches behind the eye is clipped, and stays in its half of the picture.
  OverlayOptions through;
  through.lines.push_back({.from_ws = {0.0f, -0.9f, -3.0f},
                           .to_ws = {0.0f, -0.9f, 40.0f},
                           .color = {1, 0, 0, 1},
                           .width_px = 3.0f});
  stage.frame->setOverlays(through);
  const auto changed = changes(stage.picture(), bare);
  EXPECT_GT(changed.size(), 10u);
  for (const std::size_t i : changed) EXPECT_GE(i / 64, 31u);
}

TEST_F(OverlayTest, KeyLightsAreMarkedWhereTheSkyShowsThem) {
  // The place is beside the sphere, for an eye that looks along -Z.
  const auto lights = std::vector<spec::Light>{
      spec::ConstantLight{.radiance = glm::vec3(0.5f)},
      spec::SunLight{
          .azimuth_deg = 165, .elevation_deg = 10, .angle_deg = 1, .radiance = glm::vec3(2000.0f)}};
  ViewStage stage(BundleBuilder().add({sphereMesh(12, 24), {}}), lights, linearOptions());
  stage.camera.distance_radii = 5.0f;
  stage.environment.setMostKeys(16);
  ASSERT_EQ(stage.environment.keys().size(), 1u);
  const spec::RgbaImage bare = stage.picture();
  OverlayOptions shown;
  shown.keys = true;
  stage.frame->setOverlays(shown);
  const spec::RgbaImage marked = stage.picture();
  const std::vector<std::size_t> changed = changes(marked, bare);
  EXPECT_GT(changed.size(), 20u);
  // The middle of what shines in the picture is the middle of the ring around it.
  glm::vec2 sun(0.0f);
  float count = 0.0f;
  for (std::size_t i = 0; i < bare.texels.size(); ++i)
    if (bare.texels[i].r > 500.0f && bare.texels[i].a == 0.0f) {
      sun += glm::vec2(i % 64, i / 64);
      ++count;
    }
  ASSERT_GT(count, 0.0f);
  sun /= count;
  std::size_t beside = 0;
  for (const std::size_t i : changed) beside += glm::distance(glm::vec2(i % 64, i / 64), sun) < 6.0f;
  EXPECT_GE(beside, 6u) << "a ring about it";
  ASSERT_EQ(stage.frame->parts().key_shadows.maps().size(), 1u);
  EXPECT_LT(glm::distance(stage.frame->parts().key_shadows.maps()[0].light.direction,
                          stage.environment.keys()[0].direction),
            1e-6f);
  stage.frame->setOverlays({});
  EXPECT_TRUE(changes(stage.picture(), bare).empty());
}

}  // namespace lambent::frame
