// Tests lamps that are beside a body, outside its bounds: their direct light comes per pixel with shadow
// cubes, its bounces by bands, and no path counts twice.

#include <numbers>

#include "runtime/lighting/local_light.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/frame/neighborhood_checks.hpp"

namespace lambent::frame {

class BesideLights : public testing::GpuTest {};

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFull = 1.5f;  // of surfaces that send on half as much again

struct BesideStage : NeighborhoodStage {
  ecs::Entity lamp;

  explicit BesideStage(const NeighborhoodScene& scene)
      : NeighborhoodStage(scene, {spec::ConstantLight{.radiance = glm::vec3(0.0f)}}) {
    lamp = world.registry().create();
    world.registry().emplace<scene::Transform>(lamp, scene::Transform{});
    world.registry().emplace<scene::LocalLightComponent>(lamp, scene::LocalLightComponent{.strength = 1.0f});
  }
  void moveLamp(const glm::vec3& place) { world.registry().edit<scene::Transform>(lamp).translation = place; }
  void setRadii(float radii) {
    FrameSettings settings = frame->settings();
    settings.local_radii = radii;
    ASSERT_TRUE(frame->setSettings(settings));
  }
  // Returns the largest error over all pixels of the floor, relative to the expected values.
  double worstError(const spec::RgbaImage& image, const Expected& expected, float reach) const {
    return worst(*this, image, reach, expected);
  }
};

// Returns E/pi on a floor at height 0 under a lamp of 1 cd.
float openAt(const glm::vec3& lamp, const glm::vec3& place) {
  const glm::vec3 way = lamp - place;
  return way.y / (std::pow(glm::length(way), 3.0f) * kPi);
}

// Returns the same from the lamp's light in bands at the floor's middle.
float bandsOf(const glm::vec3& lamp) {
  const sh::LightVector light = lighting::lightAt(
      {.kind = lighting::LocalLight::Kind::Point, .position_ws = lamp, .power = glm::vec3(1.0f)},
      glm::vec3(0.0f), 5);
  return irradianceOverPi(std::vector<glm::vec3>(light.c.begin(), light.c.begin() + 25), {0, 1, 0}).r;
}

// Makes an upright square, half 1, across the x axis.
BuiltReceiver screenAt(const glm::vec3& place) {
  BuiltReceiver screen;
  screen.name = "screen";
  screen.mesh = testing::quadMesh();
  screen.place = place;
  screen.turn = glm::angleAxis(0.5f * kPi, glm::vec3(0, 1, 0));
  return screen;
}

}  // namespace

TEST_F(BesideLights, ABodyBehindAScreenIsDark) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(0.5f), screenAt({1.2f, 1.0f, 0.0f})};
  BesideStage stage(scene);
  stage.half = 0.5f;
  const glm::vec3 lamp(2.5f, 1.5f, 0.0f);
  stage.moveLamp(lamp);
  for (const glm::vec4& texel : stage.picture().texels) ASSERT_LT(texel.r, 1e-6f);
  EXPECT_EQ(stage.frame->counts()["shadowed_lights"], 1u);
  stage.setRadii(0.0f);
  EXPECT_GT(stage.picture().texels[0].r, 0.5f * openAt(lamp, {0, 0, 0}))
      << "by harmonics, through the screen";
  EXPECT_EQ(stage.frame->counts()["shadowed_lights"], 0u);
}

TEST_F(BesideLights, EachPathOfTheLightComesOnceAtEveryDistance) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(0.3f)};
  scene.receivers[0].full = glm::vec3(kFull);
  BesideStage stage(scene);
  stage.half = 0.3f;
  const float radius = 0.3f * std::numbers::sqrt2_v<float>;
  const glm::vec3 towards = glm::normalize(glm::vec3(0.4f, 1.0f, 0.1f));
  // The settings give all light per pixel, all blends from one carrier to the other, and all light by bands.
  for (const float radii : {2.0f, 4.9f, 5.2f, 5.5f, 5.9f, 6.1f, 9.0f}) {
    const glm::vec3 lamp = radii * radius * towards;
    stage.moveLamp(lamp);
    const float share = std::clamp(6.0f - radii, 0.0f, 1.0f), bands = bandsOf(lamp);
    EXPECT_NEAR(bands, openAt(lamp, {0, 0, 0}), 0.04f * bands);
    const Expected expected = [&](const glm::vec3& place) {
      return glm::vec3(share * openAt(lamp, place) + (1.0f - share) * bands + (kFull - 1.0f) * bands);
    };
    EXPECT_LT(stage.worstError(stage.picture(), expected, 0.29f), 0.004) << radii << " radii away";
    EXPECT_EQ(stage.frame->counts()["shadowed_lights"], radii < 6.0f ? 1u : 0u);
  }
}

TEST_F(BesideLights, AGridTakesNothingOfWhatShadowCubesBring) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(4.0f)};
  // The body has a grid and a capture proxy, but no surface to draw into a shadow cube.
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, kFine, kFineHalf)};
  scene.bodies[0].sphere_radius = 1.0f;
  BesideStage stage(scene);
  const glm::vec3 lamp(1.0f, 6.0f, 0.0f);
  stage.moveLamp(lamp);
  const Expected open = [&](const glm::vec3& place) { return glm::vec3(openAt(lamp, place)); };
  EXPECT_LT(stage.worstError(stage.picture(), open, 3.9f), 0.004);
  EXPECT_EQ(stage.frame->counts()["neighborhood_pairs"], 1u);
  stage.setRadii(0.0f);
  EXPECT_GT(stage.worstError(stage.picture(), open, 3.9f), 0.5) << "its shadow, in the lamp's bands";
  EXPECT_EQ(stage.frame->counts()["neighborhood_pairs"], 1u);
}

}  // namespace lambent::frame
