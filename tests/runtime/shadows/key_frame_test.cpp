// Tests pictures under key lights with known answers, how the light is divided between methods, and what a
// frame draws again.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/frame/frame_parts.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/shadows/shadowed_light.hpp"
#include "tests/runtime/shadows/key_stage.hpp"
#include "tests/runtime/shadows/shadow_shaders.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

using testing::BuiltMesh;
using testing::BundleBuilder;
using testing::quadMesh;
using testing::sphereMesh;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::uint32_t kMost = FrameSettings::kAutoKeys;
constexpr int kOrder = 5;

gltf::Material grey(float albedo) {
  gltf::Material material;
  material.base_color = glm::vec4(albedo, albedo, albedo, 1.0f);
  return material;
}

// Makes a square of 2 `half` about a point, with this normal.
BuiltMesh square(glm::vec3 center, glm::vec3 normal, glm::vec2 half, float albedo = 1.0f) {
  const glm::vec3 beside = std::abs(normal.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, -1);
  const glm::vec3 right = glm::normalize(glm::cross(beside, normal)), up = glm::cross(normal, right);
  return {quadMesh(), grey(albedo),
          glm::mat4(glm::vec4(half.x * right, 0), glm::vec4(half.y * up, 0), glm::vec4(normal, 0),
                    glm::vec4(center, 1))};
}

// Adds a box of six squares that face outwards or inwards.
void addBox(BundleBuilder& builder, glm::vec3 min, glm::vec3 max, bool inside, float albedo = 1.0f) {
  const glm::vec3 center = 0.5f * (min + max), half = 0.5f * (max - min);
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      glm::vec3 at = center, normal(0.0f);
      at[axis] += side * half[axis];
      normal[axis] = inside ? -side : side;
      // The axes are those of square().
      const glm::vec2 size = axis == 0   ? glm::vec2(half.z, half.y)
                             : axis == 1 ? glm::vec2(half.x, half.z)
                                         : glm::vec2(half.x, half.y);
      builder.add(square(at, normal, size, albedo));
    }
}

// Reflects nothing by harmonics, so that only the direct light of key lights is left.
testing::TransferOf noTransfer() {
  return [](const glm::vec3&) { return std::vector<float>(kOrder * kOrder, 0.0f); };
}

spec::SunLight sun(float azimuth, float elevation, float radius_deg, float radiance = 1.0f) {
  // Overhead E/pi is `radiance`.
  const float sine = std::sin(glm::radians(radius_deg));
  return {.azimuth_deg = azimuth,
          .elevation_deg = elevation,
          .angle_deg = radius_deg,
          .radiance = glm::vec3(radiance / (sine * sine))};
}

// Looks straight down, 2 `half` wide; x to the right, z downwards.
spec::View above(float half, float from = 5.0f) {
  return {.view_from_world = glm::lookAt(glm::vec3(0, from, 0), glm::vec3(0), glm::vec3(0, 0, -1)),
          .clip_from_view = glm::ortho(-half, half, -half, half, 0.0f, 20.0f),
          .eye_ws = {0, from, 0}};
}
spec::View from(glm::vec3 eye, glm::vec3 target, float fov_deg = 50.0f) {
  return {.view_from_world = glm::lookAt(eye, target, glm::vec3(0, 1, 0)),
          .clip_from_view = glm::perspective(glm::radians(fov_deg), 1.0f, 0.05f, 50.0f),
          .eye_ws = eye};
}

glm::vec4 at(const spec::RgbaImage& image, std::uint32_t x, std::uint32_t y) {
  return image.texels[y * image.width + x];
}
// Returns the place in world space that a pixel of a perspective picture shows.
glm::vec3 placeAt(const spec::RgbaImage& image, const spec::View& view, std::uint32_t x, std::uint32_t y) {
  const glm::vec2 size(image.width, image.height);
  const glm::vec2 ndc = 2.0f * (glm::vec2(x, static_cast<float>(image.height - 1 - y)) + 0.5f) / size - 1.0f;
  const float depth = image.depths[y * image.width + x];
  const glm::vec4 place_view(depth * ndc.x / view.clip_from_view[0][0],
                             depth * ndc.y / view.clip_from_view[1][1], -depth, 1.0f);
  return glm::vec3(glm::inverse(view.view_from_world) * place_view);
}
double largestApart(const spec::RgbaImage& a, const spec::RgbaImage& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.texels.size(); ++i)
    largest = testing::larger(largest, double{glm::distance(a.texels[i], b.texels[i])});
  return largest;
}
double brightest(const spec::RgbaImage& image) {
  double most = 0.0;
  for (const glm::vec4& texel : image.texels)
    if (texel.a > 0.0f) most = testing::larger(most, double{std::max({texel.r, texel.g, texel.b})});
  return most;
}

// Makes a floor, a box and a wall, for light from any direction.
BundleBuilder court(bool bounces = false) {
  BundleBuilder builder(kOrder);
  builder.add(square({0, 0, 0}, {0, 1, 0}, {3, 3}, 0.8f)).add(square({0, 1, -1.5f}, {0, 0, 1}, {2, 1}, 0.6f));
  addBox(builder, {-0.5f, 0, -0.4f}, {0.3f, 0.7f, 0.4f}, /*inside=*/false, 0.5f);
  if (bounces) withBounces(builder);
  return builder;
}

}  // namespace

using KeyFrame = testing::GpuTest;

TEST_F(KeyFrame, NoSunComesIntoAClosedRoom) {
  BundleBuilder builder(kOrder);
  addBox(builder.transfer(noTransfer()), {-1, -1, -1}, {1, 1, 1}, /*inside=*/true);
  KeyStage stage(builder, {sun(20, 35, 0.27f), sun(140, 15, 5.0f)});
  ASSERT_EQ(stage.environment.keys().size(), 2u);
  // Where walls without thickness meet, a surface within a few texels of the map cannot be distinguished from
  // the receiver.
  constexpr float kNear = 0.03f;
  std::size_t inside = 0, all = 0;
  for (const float turn : {0.0f, 77.0f, 201.0f})
    for (const glm::vec3 target : {glm::vec3(1, 0.2f, 0.3f), {-0.4f, -1, 0.1f}, {-1, 0.7f, -1}}) {
      stage.environment.setTurn(turn);
      const spec::View view = from({0.1f, -0.2f, 0.05f}, target, 80.0f);
      const spec::RgbaImage image = stage.picture(view);
      for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
          const glm::vec3 place = placeAt(image, view, x, y);
          int walls = 0;
          for (int axis = 0; axis < 3; ++axis) walls += std::abs(place[axis]) > 1.0f - kNear ? 1 : 0;
          ASSERT_GE(walls, 1);
          ++all;
          if (walls > 1) continue;
          ++inside;
          ASSERT_EQ(at(image, x, y).r, 0.0f)
              << turn << " degrees, at " << place.x << " " << place.y << " " << place.z;
        }
    }
  EXPECT_GT(inside, all * 9 / 10);
}

TEST_F(KeyFrame, AnOpenFloorHasTheSunsIrradianceWithKeysAndWithout) {
  BundleBuilder builder(kOrder);
  builder.add(square({0, 0, 0}, {0, 1, 0}, {3, 3}));
  for (const float radius : {0.27f, 2.0f, 7.0f})
    for (const float elevation : {90.0f, 50.0f, 20.0f}) {
      const float expected = std::sin(glm::radians(elevation));
      KeyStage with(builder, {sun(30, elevation, radius)}), without(builder, {sun(30, elevation, radius)}, 0);
      for (const glm::vec4& texel : with.picture(above(1.0f)).texels)
        ASSERT_NEAR(texel.r, expected, 1e-3f) << radius << " degrees, elevation " << elevation;
      EXPECT_EQ(with.frame->counts()["key_lights"], 1u);
      // Bands from 6 on are cut off.
      for (const glm::vec4& texel : without.picture(above(1.0f)).texels)
        ASSERT_NEAR(texel.r, expected, 0.05f) << radius << " degrees, elevation " << elevation;
      EXPECT_EQ(without.frame->counts()["key_lights"], 0u);
    }
}

TEST_F(KeyFrame, AFloorThatItsNodeFlattensHasTheSunsIrradiance) {
  for (const float height : {0.0f, 1e-20f, 1e-40f}) {
    BuiltMesh floor = square({0, 0, 0}, {0, 1, 0}, {3, 3});
    floor.world_from_mesh[2] *= height;
    BundleBuilder builder(kOrder);
    builder.add(floor);
    KeyStage stage(builder, {sun(30, 50, 2)});
    for (const glm::vec4& texel : stage.picture(above(1.0f)).texels)
      ASSERT_NEAR(texel.r, std::sin(glm::radians(50.0f)), 1e-3f) << height;
  }
}

TEST_F(KeyFrame, WhereThereAreNoKeyLightsNothingIsDrawnAndNothingChanges) {
  const std::vector<spec::Light> smooth = {spec::ConstantLight{.radiance = {1.0f, 0.8f, 0.5f}}};
  for (const bool bounces : {false, true}) {
    KeyStage with(court(bounces), smooth), without(court(bounces), smooth, 0);
    const spec::View view = from({2, 2, 3}, {0, 0.4f, 0});
    const spec::RgbaImage a = with.picture(view), b = without.picture(view);
    EXPECT_EQ(largestApart(a, b), 0.0);
    EXPECT_GT(brightest(a), 0.5);
    EXPECT_EQ(with.frame->counts()["key_lights"], 0u);
    EXPECT_EQ(with.mapsDrawn(), 0u);
    EXPECT_FALSE(with.frame->parts().key_shadows.any());
    EXPECT_EQ(with.frame->parts().key_shadows.bytesResident(), 0u);
    with.frame->timers().finish();
    for (const gpu::PassTime& time : with.frame->timers().latest()) EXPECT_NE(time.name, "key shadows");
  }
}

TEST_F(KeyFrame, UnderAWhiteSkyAndSunsAnOpenSphereHasEachLightOnce) {
  // E/pi is 1 from the sky, and from each sun what a sphere of its size gives. The view is along -z, so that
  // pixels determine the normal.
  const std::vector<spec::Light> lights = {spec::ConstantLight{.radiance = glm::vec3(1.0f)},
                                           sun(60, 40, 4.0f, 3.0f), sun(-20, -10, 1.0f, 0.5f)};
  for (const bool bounces : {false, true}) {
    BundleBuilder builder(kOrder);
    builder.add({sphereMesh(96, 192), grey(1.0f)});
    if (bounces) withBounces(builder);
    KeyStage stage(builder, lights);
    ASSERT_EQ(stage.environment.keys().size(), 2u);
    const spec::View view{
        .view_from_world = glm::lookAt(glm::vec3(0, 0, 5), glm::vec3(0), glm::vec3(0, 1, 0)),
        .clip_from_view = glm::ortho(-1.1f, 1.1f, -1.1f, 1.1f, 0.0f, 20.0f),
        .eye_ws = {0, 0, 5}};
    const spec::RgbaImage image = stage.picture(view);
    int count = 0;
    double error = 0.0, largest = 0.0;
    for (std::uint32_t y = 0; y < 64; ++y)
      for (std::uint32_t x = 0; x < 64; ++x) {
        const glm::vec2 place = 1.1f * (glm::vec2(x, 63 - y) + 0.5f) / 32.0f - 1.1f;
        if (glm::length(place) > 0.97f) continue;
        const glm::vec3 normal(place, std::sqrt(1.0f - glm::dot(place, place)));
        float direct = 0.0f;
        sh::LightVector keys = stage.environment.keyLight().truncated(kOrder);
        for (const spec::Disc& key : stage.environment.keys())
          direct += key.radiance.r * glsl::KeyShader().sphereShare(glm::dot(normal, key.direction),
                                                                   1.0f / std::sin(key.radius_rad));
        std::vector<float> open(kOrder * kOrder);
        sh::unoccludedTransfer(kOrder, normal, open);
        float bounced = 0.0f;
        for (std::size_t i = 0; i < open.size(); ++i) bounced += 0.5f * open[i] * keys.c[i].r;
        const float expected = bounces ? 1.5f + direct + bounced : 1.0f + direct;
        const double apart = std::abs(double{at(image, x, y).r} - double{expected});
        error += apart;
        largest = testing::larger(largest, apart);
        ++count;
      }
    // Triangles for the sphere show where suns rise over its horizon.
    EXPECT_LT(error / count, 1e-3) << (bounces ? "with" : "without") << " bounces";
    EXPECT_LT(largest, 0.04) << (bounces ? "with" : "without") << " bounces";
  }
}

TEST_F(KeyFrame, AStillSceneDrawsNoMapAgain) {
  KeyStage stage(court(),
                 {sun(40, 45, 0.27f), sun(200, 30, 5.0f), spec::ConstantLight{.radiance = glm::vec3(0.3f)}});
  const glm::vec3 eye(2, 2, 3);
  const spec::View view = from(eye, {0, 0.4f, 0});
  stage.render(view);
  EXPECT_EQ(stage.frame->counts()["key_lights"], 2u);
  EXPECT_EQ(stage.mapsDrawn(), 2u);
  const spec::RgbaImage first = stage.picture(view);
  EXPECT_EQ(stage.mapsDrawn(), 0u) << "a still scene";
  stage.render(from(eye + glm::vec3(0.01f, -0.005f, 0), {0, 0.4f, 0}));
  EXPECT_EQ(stage.mapsDrawn(), 0u) << "the camera moved a little";
  stage.environment.setIntensity(0.5f);
  stage.render(view);
  EXPECT_EQ(stage.mapsDrawn(), 0u) << "lights of another strength cast the same shadows";
  stage.environment.setIntensity(1.0f);
  EXPECT_EQ(largestApart(stage.picture(view), first), 0.0);
  stage.environment.setTurn(1.0f);
  stage.render(view);
  EXPECT_EQ(stage.mapsDrawn(), 2u) << "the lights turned";
  stage.environment.setTurn(0.0f);
  stage.render(view);
  // The top of the box is raised.
  ecs::Registry& registry = stage.world.registry();
  ecs::Entity top;
  for (auto [entity, name] : registry.view<const scene::Name>())
    if (name.value == "node" && registry.has<scene::Transform>(entity) &&
        std::abs(registry.get<scene::Transform>(entity).translation.y - 0.7f) < 1e-3f)
      top = entity;
  ASSERT_TRUE(registry.has<scene::Transform>(top));
  registry.edit<scene::Transform>(top).translation.y += 0.2f;
  stage.render(view);
  EXPECT_EQ(stage.mapsDrawn(), 2u) << "a body moved";
  stage.render(view);
  EXPECT_EQ(stage.mapsDrawn(), 0u);
  stage.frame->forget();
  stage.render(view);
  EXPECT_EQ(stage.mapsDrawn(), 2u) << "all was forgotten";
}

TEST_F(KeyFrame, LightsThatComeLaterShineAsThoseThatWereThereFromTheStart) {
  const std::vector<spec::Light> smooth = {spec::ConstantLight{.radiance = glm::vec3(0.5f)}};
  const std::vector<spec::Light> suns = {sun(40, 45, 0.27f, 2.0f),
                                         spec::ConstantLight{.radiance = glm::vec3(0.2f)}};
  const spec::View view = from({2, 2, 3}, {0, 0.4f, 0});
  KeyStage fresh(court(/*bounces=*/true), suns), changed(court(/*bounces=*/true), smooth);
  KeyStage switched(court(/*bounces=*/true), suns, 0);
  const spec::RgbaImage expected = fresh.picture(view), dull = changed.picture(view),
                        off = switched.picture(view);
  ASSERT_TRUE(changed.environment.setLights(suns));
  EXPECT_EQ(largestApart(changed.picture(view), expected), 0.0) << "also what of them bounces";
  ASSERT_TRUE(changed.environment.setLights(smooth));
  EXPECT_EQ(largestApart(changed.picture(view), dull), 0.0);
  EXPECT_FALSE(changed.frame->parts().key_shadows.any());
  switched.environment.setMostKeys(kMost);
  EXPECT_EQ(largestApart(switched.picture(view), expected), 0.0);
  switched.environment.setMostKeys(0);
  EXPECT_EQ(largestApart(switched.picture(view), off), 0.0);
}

TEST_F(KeyFrame, LightWithoutShadowsGoesByBandsAltogether) {
  const std::vector<spec::Light> suns = {sun(40, 45, 0.27f, 2.0f),
                                         spec::ConstantLight{.radiance = glm::vec3(0.2f)}};
  FrameSettings settings;
  settings.transfer = evaluate::TransferMode::Unshadowed;
  KeyStage with(court(), suns, kMost, settings), without(court(), suns, 0, settings);
  const spec::View view = from({2, 2, 3}, {0, 0.4f, 0});
  const spec::RgbaImage a = with.picture(view), b = without.picture(view);
  EXPECT_EQ(with.frame->counts()["key_lights"], 1u);
  EXPECT_FALSE(with.frame->parts().key_shadows.any());
  EXPECT_GT(brightest(b), 1.0);
  EXPECT_LT(largestApart(a, b), 1e-5 * brightest(b));
}

TEST_F(KeyFrame, GroupsHaveAllOfTheLightInTheirTwoBlocks) {
  lighting::Environment environment = *lighting::Environment::create(
      {sun(40, 45, 0.27f, 2.0f), sun(100, 20, 30.0f), spec::ConstantLight{.radiance = {0.3f, 0.4f, 0.5f}}},
      {sun(-70, 60, 4.0f), spec::ConstantLight{.radiance = glm::vec3(0.1f)}});
  environment.setMostKeys(kMost);
  ASSERT_GE(environment.keys().size(), 2u);
  const sh::LightVector own = sh::discLight(sh::kMaxOrder, glm::vec3(0, 1, 0), 0.5, glm::vec3(1, 2, 3)),
                        own_key = sh::discLight(sh::kMaxOrder, glm::normalize(glm::vec3(1, 1, 0)), 0.1,
                                                glm::vec3(50));
  std::vector<lighting::GroupPlace> places;
  for (std::uint32_t i = 0; i < 6; ++i) {
    places.push_back({.world_from_group =
                          glm::angleAxis(0.9f * static_cast<float>(i), glm::normalize(glm::vec3(1, 2, -1))),
                      .order = i < 3 ? 5u : 3u + i,
                      .lamps = {glm::vec3(7.0f)},
                      .key = i + 1,
                      .parted = i % 3 != 2});
    places.back().incident = {{}, {.light = &own, .key = &own_key, .version = 1}};
  }
  lighting::GroupLights lights;
  gpu::Counters counters;
  const auto check = [&](const std::string& what) {
    lights.update(environment, sh::Window::Off, places, counters);
    EXPECT_TRUE(lights.hasKeys());
    for (std::size_t g = 0; g < places.size(); ++g) {
      const int order = static_cast<int>(places[g].order);
      const sh::Rotation turn(glm::conjugate(glm::dquat(places[g].world_from_group)), order);
      for (std::size_t k = 0; k < 2; ++k) {
        const sh::LightVector whole =
            turn.apply((k == 0 ? environment.light() : own + own_key).truncated(order));
        const sh::LightVector key = turn.apply((k == 0 ? environment.keyLight() : own_key).truncated(order));
        const auto first =
            lights.coefficients().subspan(lights.firstOf(g, k), lighting::GroupLights::kStride);
        for (std::size_t c = 0; c < lighting::GroupLights::kBlock; ++c) {
          const bool counts = c < places[g].order * places[g].order;
          const glm::vec3 rest(first[c]), of_keys(first[lighting::GroupLights::kBlock + c]);
          const glm::vec3 all = counts ? whole.c[c] : glm::vec3(0.0f);
          EXPECT_LT(glm::distance(rest + of_keys, all), 1e-4f)
              << what << ", group " << g << " " << k << " " << c;
          EXPECT_LT(glm::distance(of_keys, counts && places[g].parted ? key.c[c] : glm::vec3(0.0f)), 1e-4f)
              << what << ", group " << g << " " << k << " " << c;
        }
      }
      EXPECT_EQ(lights.coefficients()[lights.lampsOf(g)], glm::vec4(7, 7, 7, 0));
    }
  };
  check("at first");
  environment.setTurn(40.0f);
  check("turned");
  environment.setFade(0.3f);
  environment.setIntensity(1.7f);
  check("faded");
  environment.setFade(1.0f);
  check("of the second set");
  for (lighting::GroupPlace& place : places) place.parted = !place.parted;
  check("parted the other way");
}

}  // namespace lambent::frame
