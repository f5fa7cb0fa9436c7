// Tests what may change while a scene is shown (settings, materials, the light), and what frames report about
// it.
#include <limits>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "baker/brdf/brdf.hpp"
#include "runtime/scene/materials.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/image.hpp"
#include "tests/support/frame/live_stage.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::farthest;
using testing::LiveStage;
using testing::quadMesh;
using testing::sphereMesh;

using testing::kWhite;
const spec::Light kSun = spec::SunLight{
    .azimuth_deg = 60, .elevation_deg = 35, .angle_deg = 8, .radiance = glm::vec3(30.0f, 25.0f, 20.0f)};

gltf::Material diffuseColored(glm::vec4 color) {
  gltf::Material material;
  material.base_color = color;
  material.metallic = 0.0f;  // and roughness 1: diffuse
  return material;
}

gltf::Material metalOf(glm::vec3 color, float roughness) {
  gltf::Material material;
  material.base_color = glm::vec4(color, 1.0f);
  material.roughness = roughness;
  return material;
}

BundleBuilder glossyBall(const gltf::Material& material) {
  static const bundle::BrdfTable table =
      baker::integrateTable(*baker::makeGgx(/*anisotropic=*/false), 5,
                            {.angles = 8, .azimuths = 1, .roughnesses = 5, .strengths = 1});
  BundleBuilder builder(5);
  builder.add({sphereMesh(24, 48), material}).glossy(5, bundle::BrdfFamily::Ggx, table);
  return builder;
}

// Makes a ball whose transfer has a different value in each block and band, and a cloud beside it.
BundleBuilder ballAndCloud() {
  BundleBuilder builder(5);
  builder.bounces().transfer([](const glm::vec3& normal) {
    const std::vector<float> open = testing::openTransfer(5)(normal);
    std::vector<float> blocks;
    for (const float factor : {0.5f, 0.75f})
      for (const float value : open) blocks.push_back(factor * value);
    return blocks;
  });
  builder.add({sphereMesh(12, 24), diffuseColored({0.8f, 0.6f, 0.4f, 1.0f})});
  testing::BuiltVolume cloud;
  cloud.group_from_grid = glm::translate(glm::mat4(1.0f), glm::vec3(0.5f, -1.0f, 0.5f)) *
                          glm::scale(glm::mat4(1.0f), glm::vec3(0.25f));
  cloud.density = [](const glm::vec3& at) { return at.x > 3.0f && at.x < 5.0f ? 1.0f : 0.1f; };
  builder.volume(cloud);
  return builder;
}

}  // namespace

using LiveFrame = testing::GpuTest;

TEST_F(LiveFrame, AChangedColorIsWhatABundleOfThatColorShows) {
  LiveStage live(BundleBuilder().add({sphereMesh(12, 24), diffuseColored({0.2f, 0.9f, 0.1f, 1.0f})}), {kSun});
  live.picture();
  live.editMaterial(0).base_color = {0.7f, 0.3f, 0.5f};
  live.editMaterial(0).emission = {0.1f, 0.2f, 0.3f};
  const auto found = live.picture();
  gltf::Material wanted = diffuseColored({0.7f, 0.3f, 0.5f, 1.0f});
  wanted.emissive = {0.1f, 0.2f, 0.3f};
  LiveStage baked(BundleBuilder().add({sphereMesh(12, 24), wanted}), {kSun});
  EXPECT_EQ(farthest(found, baked.picture()), 0.0f);
}

TEST_F(LiveFrame, AChangedLobeIsWhatABundleOfThatLobeShows) {
  LiveStage live(glossyBall(metalOf(glm::vec3(0.9f), 0.7f)), {kSun});
  const auto before = live.picture();
  scene::MaterialComponent& material = live.editMaterial(0);
  material.base_color = {0.9f, 0.5f, 0.2f};
  material.roughness = 0.3f;
  material.metallic = 0.5f;
  material.ior = 1.8f;
  const auto found = live.picture();
  EXPECT_GT(farthest(found, before), 0.1f);
  gltf::Material wanted = metalOf({0.9f, 0.5f, 0.2f}, 0.3f);
  wanted.metallic = 0.5f;
  wanted.ior = 1.8f;
  LiveStage baked(glossyBall(wanted), {kSun});
  EXPECT_EQ(farthest(found, baked.picture()), 0.0f);
}

TEST_F(LiveFrame, OnlyTheChangedMaterialGoesToTheGpuAndNothingIsShaded) {
  BundleBuilder builder;
  for (int i = 0; i < 10; ++i)
    builder.add({quadMesh(), diffuseColored(glm::vec4(1.0f)),
                 glm::translate(glm::mat4(1.0f), glm::vec3(static_cast<float>(i), 0, 0))});
  LiveStage stage(builder, {kWhite});
  stage.picture();
  stage.editMaterial(3).base_color = glm::vec3(0.5f);
  stage.render();
  EXPECT_EQ(stage.pass("raster")->counters.uploaded_bytes, sizeof(SurfaceDraw));
  EXPECT_EQ(stage.pass("shade")->counters.dispatches, 0u);
  EXPECT_EQ(stage.reason("raster"), "materials changed");
  stage.editMaterial(3).roughness = std::numeric_limits<float>::quiet_NaN();
  stage.render();
  EXPECT_EQ(stage.pass("raster")->counters.uploaded_bytes, 0u) << "no number, no change";
}

TEST_F(LiveFrame, EverySettingComesBackToTheSamePicture) {
  FrameSettings plain;
  plain.exposure_ev = 0.0f;
  const std::pair<const char*, const char*> changes[] = {
      {"transfer", "unshadowed"}, {"transfer", "shadowed"}, {"window", "auto"},   {"order", "2"},
      {"diffuse", "off"},         {"volumes", "off"},       {"march-step", "4"},  {"captures", "off"},
      {"local-shadows", "off"},   {"neighborhoods", "off"}, {"capture-size", "8"}};
  LiveStage stage(ballAndCloud(), {kSun}, plain);
  const auto before = stage.picture();
  for (const auto& [name, word] : changes) {
    const std::string was = settingWord(*findSetting(name), stage.frame->settings());
    stage.set(name, word);
    const auto other = stage.picture();
    const bool shows = std::string_view(name) == "transfer" || std::string_view(name) == "window" ||
                       std::string_view(name) == "order" || std::string_view(name) == "diffuse" ||
                       std::string_view(name) == "volumes" || std::string_view(name) == "march-step";
    EXPECT_EQ(farthest(other, before) > 1e-4f, shows) << name;
    stage.set(name, was);
    EXPECT_EQ(farthest(stage.picture(), before), 0.0f) << name << " back to " << was;
  }
  LiveStage glossy(glossyBall(metalOf(glm::vec3(0.9f), 0.5f)), {kSun}, plain);
  const auto shiny = glossy.picture();
  for (const auto& [name, word] :
       {std::pair{"glossy", "off"}, {"specular-environment", "off"}, {"glossy-order", "3"}}) {
    const std::string was = settingWord(*findSetting(name), glossy.frame->settings());
    glossy.set(name, word);
    EXPECT_GT(farthest(glossy.picture(), shiny), 1e-3f) << name;
    glossy.set(name, was);
    EXPECT_EQ(farthest(glossy.picture(), shiny), 0.0f) << name;
  }
}

TEST_F(LiveFrame, WhatIsOffIsBlackAndCostsNothing) {
  LiveStage stage(BundleBuilder().add({sphereMesh(12, 24), diffuseColored(glm::vec4(1.0f))}), {kSun});
  stage.set("diffuse", "off");
  const auto picture = stage.picture();
  EXPECT_EQ(picture[32 * 64 + 32], glm::vec4(0, 0, 0, 1));
  stage.environment.setTurn(30.0f);
  stage.render();
  EXPECT_EQ(stage.pass("shade")->counters.dispatches, 0u);
  stage.set("diffuse", "on");
  const auto back = stage.picture();
  LiveStage fresh(BundleBuilder().add({sphereMesh(12, 24), diffuseColored(glm::vec4(1.0f))}), {kSun});
  fresh.environment.setTurn(30.0f);
  EXPECT_EQ(farthest(back, fresh.picture()), 0.0f) << "it catches up";
}

TEST_F(LiveFrame, BandsThatDoNotCountAreAsIfTheTransferHadNone) {
  FrameSettings sharp;
  sharp.window = sh::Window::Off;
  LiveStage many(BundleBuilder(5).add({sphereMesh(12, 24), diffuseColored(glm::vec4(1.0f))}), {kSun}, sharp);
  LiveStage few(BundleBuilder(3).add({sphereMesh(12, 24), diffuseColored(glm::vec4(1.0f))}), {kSun}, sharp);
  const auto all = many.picture(), expected = few.picture();
  EXPECT_GT(farthest(all, expected), 0.01f);
  many.set("order", "3");
  EXPECT_LT(farthest(many.picture(), expected), 2e-4f) << "codes of 16 bits";
}

TEST_F(LiveFrame, PassesSayWhyTheyRanAndAStillSceneSaysNothing) {
  LiveStage stage(BundleBuilder().add({sphereMesh(12, 24), diffuseColored(glm::vec4(1.0f))}), {kSun});
  stage.render();
  EXPECT_EQ(stage.reason("shade"), "first frame");
  stage.picture();
  stage.frame->timers().finish();
  for (const gpu::PassTime& pass : stage.frame->timers().latest()) EXPECT_EQ(pass.reason, "") << pass.name;
  stage.environment.setTurn(10.0f);
  stage.render();
  for (const char* pass : {"light", "shade", "raster", "tone map"})
    EXPECT_EQ(stage.reason(pass), "light turned") << pass;
  EXPECT_EQ(stage.reason("transforms"), "");
  stage.camera.azimuth_deg += 5.0f;
  stage.render();
  EXPECT_EQ(stage.reason("raster"), "camera");
  EXPECT_EQ(stage.reason("shade"), "");
  auto& registry = stage.world.registry();
  registry.edit<scene::Transform>(stage.world.instance(0).root).translation.x += 1.0f;
  stage.world.updateTransforms();
  stage.render();
  EXPECT_EQ(stage.reason("transforms"), "groups moved");
  stage.set("window", "auto");
  stage.render();
  EXPECT_EQ(stage.reason("shade"), "ringing suppression: auto");
  stage.set("exposure", "1");
  stage.render();
  EXPECT_EQ(stage.reason("shade"), "");
  EXPECT_EQ(stage.reason("tone map"), "exposure: 1");
}

}  // namespace lambent::frame
