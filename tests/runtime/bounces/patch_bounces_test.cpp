// Renders a closed sphere with a lamp at its centre: E is the same everywhere, and bounces multiply it by 1 /
// (1 - albedo).
#include "runtime/bounces/patch_bounces.hpp"

#include <cmath>
#include <cstring>

#include "runtime/sh/zonal.hpp"
#include "tests/runtime/lighting/rooms.hpp"
#include "tests/support/frame/live_stage.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {

using PatchBouncesTest = testing::GpuTest;
using testing::BuiltMesh;
using testing::BundleBuilder;
using testing::LiveStage;
using testing::RoomBuilder;

namespace {

constexpr float kAlbedo = 0.6f;

// Makes a sphere of radius 1 that is visible from inside.
BuiltMesh insideOfSphere() {
  BuiltMesh mesh{testing::sphereMesh(24, 48), {}};
  for (glm::vec3& normal : mesh.data.normals) normal = -normal;
  for (std::size_t i = 0; i < mesh.data.indices.size(); i += 3)
    std::swap(mesh.data.indices[i + 1], mesh.data.indices[i + 2]);
  mesh.material.base_color = glm::vec4(kAlbedo, kAlbedo, kAlbedo, 1.0f);
  return mesh;
}

struct RoomStage : LiveStage {
  ecs::Entity lamp;

  explicit RoomStage(const BundleBuilder& builder)
      : LiveStage(builder, {spec::ConstantLight{.radiance = glm::vec3(0.0f)}}) {
    bundle::CaptureProxy proxy = RoomBuilder().sphere(10, 14, glm::vec3(kAlbedo)).proxy();
    EXPECT_TRUE(world.residency().upload(0, streaming::ProxyChunk{{}, std::move(proxy)}));
    lamp = world.registry().create();
    world.registry().emplace<scene::Transform>(lamp, scene::Transform{});
    world.registry().emplace<scene::LocalLightComponent>(lamp, scene::LocalLightComponent{.strength = 4.0f});
  }
  scene::LocalLightComponent& light() { return world.registry().edit<scene::LocalLightComponent>(lamp); }
  void moveLamp(const glm::vec3& place) { world.registry().edit<scene::Transform>(lamp).translation = place; }
};

// Returns the mean over the middle of the picture, which shows the far side of the sphere.
double middleOf(const std::vector<glm::vec4>& picture) {
  double sum = 0.0;
  int count = 0;
  for (int y = 24; y < 40; ++y)
    for (int x = 24; x < 40; ++x, ++count) sum += picture[static_cast<std::size_t>(64 * y + x)].g;
  return sum / count;
}

}  // namespace

TEST_F(PatchBouncesTest, InAClosedSphereTheyAddAlbedoOverOneMinusAlbedo) {
  for (const bool mapped : {false, true}) {
    BundleBuilder builder;
    builder.add(insideOfSphere());
    if (mapped) {
      builder.normalMapped();
      builder.transfer([](const glm::vec3&) { return std::vector<float>(81, 0.0f); });
    }
    RoomStage stage(builder);
    const double with = middleOf(stage.picture());
    EXPECT_EQ(stage.frame->counts()["patch_rooms"], 1u);
    stage.set("patch-bounces", "off");
    const double without = middleOf(stage.picture());
    EXPECT_NEAR(without, kAlbedo * 4.0 / 3.14159, 0.03) << "E/pi of 4 cd at 1 m";
    EXPECT_NEAR((with / without - 1.0) / (kAlbedo / (1.0 - kAlbedo)), 1.0, 0.03)
        << (mapped ? "mapped" : "plain");
  }
}

TEST_F(PatchBouncesTest, WhatDoesNotChangeIsNeitherBouncedNorGathered) {
  RoomStage stage(BundleBuilder().add(insideOfSphere()));
  (void)stage.picture();
  stage.render();
  const auto pass = stage.pass("patch bounces");
  ASSERT_TRUE(pass);
  EXPECT_EQ(pass->counters.dispatches, 0u);
  EXPECT_EQ(pass->counters.uploaded_bytes, 0u);
  EXPECT_EQ(stage.frame->counts()["lights_bounced"], 0u);
  stage.light().strength = 2.0f;
  stage.render();
  EXPECT_EQ(stage.frame->counts()["lights_bounced"], 0u) << "dimmed";
  EXPECT_EQ(stage.frame->counts()["patch_draws_gathered"], 1u);
  stage.moveLamp({0.1f, 0, 0});
  stage.render();
  EXPECT_EQ(stage.frame->counts()["lights_bounced"], 1u) << "moved";
}

// Patches are coarse: beside a bright sill they may claim more light than there is. A sun that its bands
// bring in, and whose rays pass along floor and ceiling, then took away all the light there was.
TEST_F(PatchBouncesTest, WherePatchesClaimMoreThanTransferKnowsTheyTakeAwayInProportion) {
  for (const bool mapped : {false, true}) {
    // Transfer knows of a little bounced light. Patches are a floor and a ceiling, whose light is a hundred
    // times that.
    const auto pictureOf = [&](float known) {
      BundleBuilder builder;
      builder.add(insideOfSphere()).bounces();
      if (mapped) builder.normalMapped();
      const std::size_t size = 2 * 9 * (mapped ? 9 : 1);
      builder.transfer([&](const glm::vec3&) {
        std::vector<float> transfer(size, 0.0f);
        transfer[size / 2] = known;
        return transfer;
      });
      LiveStage stage(
          builder,
          {spec::ConstantLight{.radiance = glm::vec3(1.0f)},
           spec::SunLight{
               .azimuth_deg = 90, .elevation_deg = 0, .angle_deg = 4, .radiance = glm::vec3(2000.0f)}});
      stage.environment.setMostKeys(FrameSettings::kAutoKeys);
      const glm::vec3 low(-1.2f), high(1.2f), x(2.4f, 0, 0), z(0, 0, 2.4f), albedo(0.8f);
      bundle::CaptureProxy hall = RoomBuilder().wall(low, z, x, albedo).wall(high, -x, -z, albedo).proxy();
      EXPECT_TRUE(stage.world.residency().upload(0, streaming::ProxyChunk{{}, std::move(hall)}));
      const double shown = middleOf(stage.picture());
      EXPECT_EQ(stage.frame->counts()["patch_rooms"], 1u);
      return shown;
    };
    EXPECT_NEAR(pictureOf(0.0f), 0.0, 1e-3) << (mapped ? "mapped" : "plain");
    if (mapped) continue;
    const double little = pictureOf(1e-3f), twice = pictureOf(2e-3f);
    EXPECT_GT(little, 0.0) << "the sky's share stays";
    EXPECT_NEAR(twice / little, 2.0, 0.02);
  }
}

}  // namespace lambent::frame
