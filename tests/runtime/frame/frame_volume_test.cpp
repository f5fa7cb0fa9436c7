// Tests volumes in pictures with known answers, and what a frame does for them.

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/effects/volume/volume.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "tests/support/frame/view_stage.hpp"

namespace lambent::frame {
namespace {

using testing::BuiltVolume;
using testing::BundleBuilder;
using testing::quadMesh;
using testing::sphereMesh;

constexpr std::uint32_t kVolumeSide = 64;
using testing::kWhite;

using testing::colored;

FrameOptions linearOptions(const std::function<void(FrameOptions&)>& change = {}) {
  FrameOptions options;
  options.output = Output::Linear;
  if (change) change(options);
  return options;
}

// Makes a homogeneous cube of 2 m.
BuiltVolume mist(float extinction, float albedo = 1.0f) {
  BuiltVolume volume;
  volume.density_max = extinction;
  volume.density = [extinction](const glm::vec3&) { return extinction; };
  volume.albedo = glm::vec3(albedo);
  return volume;
}

// Has an orthographic camera of 3 m, 10 m away on +Z.
struct VolumeStage : testing::ViewStage {
  spec::View view;

  VolumeStage(const BundleBuilder& builder, const std::vector<spec::Light>& lights = {kWhite},
              const FrameOptions& options = linearOptions())
      : ViewStage(builder, lights, options) {
    scene::addLights(world.registry(), lights);
    world.updateTransforms();
    view.eye_ws = {0, 0, 10};
    view.view_from_world = glm::lookAt(view.eye_ws, glm::vec3(0.0f), glm::vec3(0, 1, 0));
    view.clip_from_view = glm::ortho(-1.5f, 1.5f, -1.5f, 1.5f, 1.0f, 20.0f);
  }
  void render() { ViewStage::render(view); }
  spec::RgbaImage picture() {
    render();
    return frame->readLinear();
  }
};

glm::vec4 texelAt(const spec::RgbaImage& image, std::uint32_t x, std::uint32_t y) {
  return image.texels[y * image.width + x];
}
glm::vec4 middle(const spec::RgbaImage& image) {
  return texelAt(image, kVolumeSide / 2, kVolumeSide / 2);
}

}  // namespace

using FrameVolume = testing::GpuTest;

TEST_F(FrameVolume, ABundleOfNothingButAVolumeIsFramedAndShows) {
  VolumeStage stage(BundleBuilder().volume(mist(0.7f, 0.5f)));
  const scene::Box bounds = scene::worldBounds(stage.world.registry());
  EXPECT_LT(glm::distance(bounds.min, glm::vec3(-1.0f)), 1e-5f);
  EXPECT_LT(glm::distance(bounds.max, glm::vec3(1.0f)), 1e-5f);
  const spec::RgbaImage image = stage.picture();
  const float through = std::exp(-0.7f * 2.0f);
  EXPECT_LT(
      glm::distance(middle(image), glm::vec4(glm::vec3(0.5f * (1.0f - through) + through), 1.0f - through)),
      1e-3f)
      << "codebooks are of half floats";
  EXPECT_EQ(texelAt(image, 1, 1).a, 0.0f);
  EXPECT_EQ(stage.frame->counts()["volumes"], 1u);
  EXPECT_EQ(stage.frame->counts()["volumes_drawn"], 1u);
}

TEST_F(FrameVolume, EverythingWhiteUnderWhiteLightIsWhite) {
  // A sphere is half in the mist, a quad is behind it, then the sky. All light is uniform.
  BundleBuilder builder;
  builder.add({sphereMesh(16, 32), colored(glm::vec4(1.0f)),
               glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-0.3f, 0.2f, 0.9f)), glm::vec3(0.5f))});
  builder.add(
      {quadMesh(), colored(glm::vec4(1.0f)), glm::translate(glm::mat4(1.0f), glm::vec3(0.7f, 0.0f, -2.0f))});
  for (const float extinction : {1e-6f, 1.0f, 30.0f, 1e6f}) {
    VolumeStage stage(BundleBuilder(builder).volume(mist(extinction)));
    const spec::RgbaImage image = stage.picture();
    for (const glm::vec4& texel : image.texels)
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(texel[c], 1.0f, 1e-3f) << extinction;
    EXPECT_EQ(stage.frame->negativePixels(), 0u);
  }
}

TEST_F(FrameVolume, DimsSurfacesByWhatLiesBeforeThem) {
  // In black mist a white quad shows exp(-extinction * distance through it).
  for (const auto& [z, way] : {std::pair{-2.0f, 2.0f}, {-0.5f, 1.5f}, {0.75f, 0.25f}, {2.0f, 0.0f}}) {
    BundleBuilder builder;
    builder.add({quadMesh(), colored(glm::vec4(1.0f)), glm::translate(glm::mat4(1.0f), glm::vec3(0, 0, z))});
    VolumeStage stage(builder.volume(mist(0.8f, 0.0f)));
    for (const bool perspective : {false, true}) {
      if (perspective) stage.view.clip_from_view = glm::perspective(glm::radians(10.0f), 1.0f, 1.0f, 20.0f);
      const glm::vec4 texel = middle(stage.picture());
      EXPECT_NEAR(texel.g, std::exp(-0.8f * way), 2e-3f) << z;
      EXPECT_EQ(texel.a, 1.0f);
    }
  }
}

TEST_F(FrameVolume, BlendedSurfacesLieBehindIt) {
  gltf::Material glass = colored({1.0f, 0.0f, 0.0f, 0.25f});
  glass.alpha_mode = gltf::AlphaMode::Blend;
  VolumeStage stage(BundleBuilder().add({quadMesh(), glass}).volume(mist(0.5f, 0.0f)));
  const float through = std::exp(-1.0f);
  const glm::vec4 texel = middle(stage.picture());
  EXPECT_LT(
      glm::distance(texel, glm::vec4(through, 0.75f * through, 0.75f * through, 1.0f - through * 0.75f)),
      2e-3f);
}

TEST_F(FrameVolume, AStillFrameOnlyMarches) {
  VolumeStage stage(
      BundleBuilder().volume(mist(1.0f)),
      {spec::SunLight{.azimuth_deg = 90, .elevation_deg = 0, .angle_deg = 30, .radiance = glm::vec3(1)}});
  stage.render();
  ASSERT_TRUE(stage.pass("volume"));
  ASSERT_TRUE(stage.pass("march"));
  EXPECT_EQ(stage.pass("volume")->counters.dispatches, 1u);
  EXPECT_EQ(stage.pass("march")->counters.draws, 1u);
  EXPECT_EQ(stage.frame->counts()["volumes_shaded"], 1u);
  EXPECT_EQ(stage.frame->counts()["volume_slabs_written"], 1u);
  stage.render();
  EXPECT_EQ(stage.pass("volume")->counters.dispatches, 0u);
  EXPECT_EQ(stage.pass("volume")->counters.uploaded_bytes, 0u);
  EXPECT_EQ(stage.pass("shade")->counters.dispatches, 0u);
  EXPECT_EQ(stage.frame->counts()["volumes_shaded"], 0u);
  stage.view.view_from_world = glm::lookAt(glm::vec3(1, 2, 9), glm::vec3(0.0f), glm::vec3(0, 1, 0));
  stage.render();
  EXPECT_EQ(stage.pass("volume")->counters.dispatches, 0u) << "light in it does not depend on the camera";
  stage.environment.setTurn(5.0f);
  stage.render();
  EXPECT_EQ(stage.pass("volume")->counters.dispatches, 1u);
}

TEST_F(FrameVolume, ForwardScatteringShowsTheSunBehindIt) {
  BuiltVolume volume = mist(1e4f);
  volume.g = 0.7f;
  volume.shape = {.order = 4, .outputs = 16, .visibility_bands = 7};
  for (const float azimuth : {0.0f, 180.0f}) {  // 180: behind the volume, the camera looks into it
    VolumeStage stage(
        BundleBuilder().volume(volume),
        {spec::SunLight{
            .azimuth_deg = azimuth, .elevation_deg = 0, .angle_deg = 20, .radiance = glm::vec3(1)}},
        linearOptions([](FrameOptions& options) { options.settings.window = sh::Window::Off; }));
    const sh::LightVector& light = stage.environment.light();
    const glm::vec3 along(0, 0, -1);
    std::array<float, 16> y{};
    sh::evaluate(4, along, y);
    float expected = 0.0f;
    for (int i = 0; i < 16; ++i)
      expected += std::pow(0.7f, static_cast<float>(sh::bandOf(i))) * y[static_cast<std::size_t>(i)] *
                  light.c[static_cast<std::size_t>(i)].g;
    EXPECT_NEAR(middle(stage.picture()).g, expected, 1e-3f * std::abs(expected) + 1e-4f);
    if (azimuth == 180.0f) {
      EXPECT_GT(expected, 3.0f * 0.282094792f * light.c[0].g) << "brighter than by isotropic scattering";
    }
  }
}

TEST_F(FrameVolume, ALightInsideShinesByHarmonics) {
  // Local lights are for surfaces: rays through the mist look up no shadow cube.
  const spec::Light lamp = spec::SphereLight{
      .position_ws = glm::vec3(0.3f, 0.0f, 0.0f), .radius_m = 0.1f, .radiance = glm::vec3(50.0f)};
  VolumeStage stage(BundleBuilder().volume(mist(2.0f)), {lamp});
  const spec::RgbaImage image = stage.picture();
  EXPECT_EQ(stage.frame->counts()["local_lights"], 1u);
  EXPECT_EQ(stage.frame->counts()["shadowed_lights"], 0u);
  EXPECT_GT(middle(image).g, 0.1f);
  for (const glm::vec4& texel : image.texels) ASSERT_TRUE(std::isfinite(texel.g));
}

TEST_F(FrameVolume, TheSurfacesThatItStandsInAreNotCapturedAtItsLightProbes) {
  for (const std::int32_t within : {-1, 0}) {
    BuiltVolume volume = mist(1.0f);
    volume.within = within;
    VolumeStage stage(BundleBuilder().add({sphereMesh(8, 16), colored(glm::vec4(1.0f))}).volume(volume));
    const LitScene before = gatherLitScene(stage.world, 1.0f);
    EXPECT_FALSE(before.needsSampling()) << "there is no body yet";
    bundle::CaptureProxy proxy;
    ASSERT_TRUE(stage.world.residency().upload(0, streaming::ProxyChunk{{}, proxy}));
    const LitScene scene = gatherLitScene(stage.world, 1.0f);
    ASSERT_EQ(scene.bodies.size(), 1u);
    EXPECT_EQ(scene.groups[0].body, 0u);
    EXPECT_EQ(scene.groups[1].body, lighting::CapturePoint::kNoBody);
    EXPECT_EQ(scene.groups[1].left_out,
              within < 0 ? std::vector<std::uint32_t>{} : std::vector<std::uint32_t>{0});
    EXPECT_EQ(scene.needsSampling(), within < 0);
  }
}

}  // namespace lambent::frame
