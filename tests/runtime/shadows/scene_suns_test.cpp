// Tests directional lights of the scene, which shine as suns at infinity do.
#include <cmath>
#include <numbers>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "runtime/light_plan/light_plan.hpp"
#include "tests/runtime/shadows/key_stage.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::quadMesh;
using SceneSuns = testing::GpuTest;

// Has a floor of 6 m and a wall of 2 m on it, both with bounces.
BundleBuilder floorAndWall() {
  BundleBuilder builder(5);
  withBounces(builder);
  gltf::Material grey;
  grey.base_color = {0.8f, 0.8f, 0.8f, 1.0f};
  const glm::mat4 one(1.0f);
  builder.add({quadMesh(), grey,
               glm::scale(glm::rotate(one, glm::radians(-90.0f), glm::vec3(1, 0, 0)), glm::vec3(3))});
  builder.add({quadMesh(), grey, glm::translate(one, glm::vec3(0, 1, -1.5f))});
  return builder;
}

spec::View fromBeside() {
  const glm::vec3 eye(2, 2, 3);
  return {.view_from_world = glm::lookAt(eye, glm::vec3(0, 0.4f, 0), glm::vec3(0, 1, 0)),
          .clip_from_view = glm::perspective(glm::radians(60.0f), 1.0f, 0.05f, 50.0f),
          .eye_ws = eye};
}

constexpr float kSunAzimuth = 200.0f, kSunElevation = 40.0f;

// Returns a node's rotation with which its light comes from there.
glm::quat towards(float azimuth_deg, float elevation_deg) {
  return glm::angleAxis(glm::radians(azimuth_deg), glm::vec3(0, 1, 0)) *
         glm::angleAxis(glm::radians(-elevation_deg), glm::vec3(1, 0, 0));
}

ecs::Entity addSun(World& world, float lux, float azimuth_deg = kSunAzimuth) {
  ecs::Registry& registry = world.registry();
  const ecs::Entity entity = registry.create();
  registry.emplace<scene::Transform>(entity).rotation = towards(azimuth_deg, kSunElevation);
  registry.emplace<scene::LocalLightComponent>(
      entity,
      scene::LocalLightComponent{.kind = scene::LocalLightComponent::Kind::Directional, .strength = lux});
  return entity;
}

// Returns the same light as one at infinity, of the radius that suns of the scene have.
spec::Light sunAtInfinity(const World& world, float lux) {
  const float radius = sunsOf(world, 1).discs.at(0).radius_rad;
  const float sine = std::sin(radius);
  return spec::SunLight{.azimuth_deg = kSunAzimuth,
                        .elevation_deg = kSunElevation,
                        .angle_deg = glm::degrees(radius),
                        .radiance = glm::vec3(lux / (std::numbers::pi_v<float> * sine * sine))};
}

const spec::Light kSky = spec::ConstantLight{.radiance = glm::vec3(0.2f)};

}  // namespace

TEST_F(SceneSuns, ShineAsASunAtInfinityDoesWithAndWithoutMaps) {
  for (const std::uint32_t most_keys : {16u, 0u}) {
    KeyStage stage(floorAndWall(), {kSky}, most_keys);
    addSun(stage.world, 3.0f);
    const spec::RgbaImage image = stage.picture(fromBeside());
    EXPECT_EQ(stage.frame->counts()["key_lights"], most_keys == 0 ? 0u : 1u);
    EXPECT_EQ(stage.frame->counts()["local_lights"], most_keys == 0 ? 1u : 0u) << "harmonics";
    KeyStage expected(floorAndWall(), {kSky, sunAtInfinity(stage.world, 3.0f)}, most_keys);
    const spec::RgbaImage wanted = expected.picture(fromBeside());
    double worst = 0.0, brightest = 0.0;
    for (std::size_t i = 0; i < image.texels.size(); ++i) {
      if (wanted.texels[i].a == 0.0f) continue;
      worst = testing::larger(worst, double{glm::distance(image.texels[i], wanted.texels[i])});
      brightest = testing::larger(brightest, double{wanted.texels[i].g});
    }
    EXPECT_GT(brightest, 0.5);
    EXPECT_LT(worst, 1e-3 * brightest) << most_keys << " key lights";
  }
}

TEST_F(SceneSuns, FollowTheirNodeButNotTheTurnOfTheSky) {
  KeyStage stage(floorAndWall(), {kSky});
  const ecs::Entity sun = addSun(stage.world, 3.0f);
  const spec::RgbaImage before = stage.picture(fromBeside());
  stage.environment.setTurn(90.0f);
  EXPECT_EQ(stage.picture(fromBeside()).texels, before.texels);
  stage.world.registry().edit<scene::Transform>(sun).rotation = towards(kSunAzimuth + 90.0f, kSunElevation);
  EXPECT_NE(stage.picture(fromBeside()).texels, before.texels);
  ASSERT_EQ(stage.environment.keys().size(), 1u);
  const glm::vec3 direction = stage.environment.keys()[0].direction;
  EXPECT_NEAR(direction.x,
              std::cos(glm::radians(kSunElevation)) * std::sin(glm::radians(kSunAzimuth + 90.0f)), 1e-5f);
  stage.world.registry().destroy(sun);
  stage.render(fromBeside());
  EXPECT_TRUE(stage.environment.keys().empty());
}

TEST_F(SceneSuns, TheBrightestHaveMapsAndTheOthersGoByHarmonics) {
  KeyStage stage(floorAndWall(), {kSky}, /*most_keys=*/2);
  for (const float lux : {1.0f, 5.0f, 2.0f, 4.0f}) addSun(stage.world, lux, 40.0f * lux);
  stage.render(fromBeside());
  ASSERT_EQ(stage.environment.keys().size(), 2u);
  const auto brightness = [&](std::size_t k) {
    return stage.environment.keys()[k].radiance.g / stage.environment.keys()[0].radiance.g;
  };
  EXPECT_NEAR(brightness(1), 4.0f / 5.0f, 1e-5f);
  EXPECT_EQ(stage.frame->counts()["local_lights"], 2u);
}

}  // namespace lambent::frame
