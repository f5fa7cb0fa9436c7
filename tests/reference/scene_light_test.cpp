// Tests lights within the scene: emissive surfaces and KHR_lights_punctual.
#include <numbers>

#include <gtest/gtest.h>

#include "tests/reference/measure.hpp"

namespace lambent::baker::reference {
namespace {

using testing::expectMean;
using testing::formFactor;
using testing::lamp;
using testing::measured;
using testing::samples;
using testing::sceneOf;

TEST(EmissiveSurface, OfAClosedBoxIsTheGeometricSeries) {
  // With radiance e and albedo rho everywhere, the result is e (1 + rho + rho² + ...).
  Scene scene = sceneOf({testing::flipped(testing::box({0, 0, 0}, {2, 1, 3}, 2))});
  scene.materials[0].base_color = glm::vec4(0.5f, 0.5f, 0.5f, 1);
  scene.materials[0].emissive = glm::vec3(1.0f);
  const auto seen = [&](std::optional<std::uint32_t> bounces) {
    return measured(scene, {0, 0, 0}, {0.3f, -0.5f, 0.4f}, {}, samples(128, bounces));
  };
  expectMean(seen(0), 1.5);
  expectMean(seen(2), 1.875);
  expectMean(seen({}), 2.0);
}

TEST(EmissiveSurface, LightsAFloorByItsFormFactor) {
  Scene scene =
      sceneOf({testing::grid({0, 0, 0}, 8.0f, 1), testing::flipped(testing::grid({0, 1, 0}, 2.0f, 3))});
  testing::paint(scene, 1, lamp(10.0f));
  for (const float x : {0.0f, 0.7f, 2.5f}) {
    const double expected =
        10.0 * formFactor({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, {x, 0, 0}, {0, 1, 0});
    const auto floor = measured(scene, {x, 0.9f, 3.0f}, {x, 0, 0}, {}, samples(128, 0));
    expectMean(floor, expected);
    EXPECT_LT(floor.error.g, 0.004 * expected);
  }
}

TEST(EmissiveSurface, ShinesFromItsFrontOnlyUnlessTwoSided) {
  for (const bool both : {false, true}) {
    Scene scene =
        sceneOf({testing::grid({0, 0, 0}, 8.0f, 1), testing::grid({0, 1, 0}, 2.0f, 1)});  // faces up
    gltf::Material material = lamp(10.0f);
    material.double_sided = both;
    testing::paint(scene, 1, material);
    const auto floor = measured(scene, {0, 0.9f, 3}, {0, 0, 0}, {}, samples(64, 0));
    const double expected =
        10.0 * formFactor({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, {0, 0, 0}, {0, 1, 0});
    expectMean(floor, both ? expected : 0.0);
  }
}

Scene floorWithLight(const gltf::Light& light, const glm::mat4& place) {
  Scene scene = sceneOf({testing::grid({0, 0, 0}, 20.0f, 1)});
  testing::addLight(scene, light, place);
  return scene;
}

// Returns the matrix of a light at this height that shines straight down, along its -Z.
glm::mat4 above(float height) {
  return glm::rotate(glm::translate(glm::mat4(1), {0, height, 0}), -glm::half_pi<float>(), {1, 0, 0});
}

double seenAt(const Scene& scene, float x) {
  return measured(scene, {x, 3, 4}, {x, 0, 0}, {}, samples(1, 0)).mean.g;
}

TEST(PunctualLight, OfPointsFallsWithTheSquareOfTheDistance) {
  // E = I cos / d² = I h / d³; E/pi is seen of white. No noise: one light, nothing in the way.
  gltf::Light light{
      .name = {}, .type = gltf::Light::Type::Point, .color = {0.5f, 1.0f, 2.0f}, .intensity = 7.0f};
  for (const float x : {0.0f, 1.0f, 5.0f})
    EXPECT_NEAR(seenAt(floorWithLight(light, above(2)), x),
                7.0 / std::numbers::pi * 2.0 / std::pow(x * x + 4.0, 1.5), 2e-5);
  light.range_m = 4.0f;
  EXPECT_NEAR(seenAt(floorWithLight(light, above(2)), 0), 7.0 / std::numbers::pi / 4.0 * (1.0 - 1.0 / 16.0),
              2e-5);
  EXPECT_EQ(seenAt(floorWithLight(light, above(2)), 4), 0.0);
}

TEST(PunctualLight, OfSpotsFadesBetweenItsCones) {
  const gltf::Light light{.name = {},
                          .type = gltf::Light::Type::Spot,
                          .intensity = 5.0f,
                          .inner_cone_rad = 0.3f,
                          .outer_cone_rad = 0.6f};
  const Scene scene = floorWithLight(light, above(2));
  for (const double angle : {0.1, 0.4, 0.5, 0.7}) {
    const double x = 2.0 * std::tan(angle);
    const double share = (std::cos(angle) - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6));
    const double inside = std::clamp(share, 0.0, 1.0);
    EXPECT_NEAR(seenAt(scene, static_cast<float>(x)),
                inside * inside * 5.0 / std::numbers::pi * std::pow(std::cos(angle), 3.0) / 4.0, 5e-5)
        << angle;
  }
}

TEST(PunctualLight, OfDirectionsIsLuxOnAFacingSurface) {
  const gltf::Light light{.name = {}, .type = gltf::Light::Type::Directional, .intensity = 3.0f};
  const glm::mat4 slanted = glm::rotate(above(2), glm::radians(60.0f), {0, 1, 0});
  EXPECT_NEAR(seenAt(floorWithLight(light, above(2)), 1), 3.0 / std::numbers::pi, 1e-5);
  EXPECT_NEAR(seenAt(floorWithLight(light, slanted), 1), 1.5 / std::numbers::pi, 1e-5);
}

TEST(PunctualLight, CastsShadowsAndAddsUp) {
  const gltf::Light light{.name = {}, .type = gltf::Light::Type::Point, .intensity = 7.0f};
  Scene scene = floorWithLight(light, above(2));
  testing::addLight(scene, {.name = {}, .type = gltf::Light::Type::Directional, .intensity = 3.0f}, above(9));
  const double both = 7.0 / std::numbers::pi / 4.0 + 3.0 / std::numbers::pi;
  expectMean(measured(scene, {0, 3, 4}, {0, 0, 0}, {}, samples(64, 0)), both, 1e-4);
  // A card is between the two lights, wider than it has to be for the floor's point.
  Scene shaded = sceneOf({testing::grid({0, 0, 0}, 20.0f, 1), testing::grid({0, 3, 0}, 1.0f, 1)});
  for (std::size_t i = 1; i < scene.nodes.size(); ++i) shaded.nodes.push_back(scene.nodes[i]);
  shaded.lights = scene.lights;
  expectMean(measured(shaded, {0, 1, 4}, {0, 0, 0}, {}, samples(64, 0)), 7.0 / std::numbers::pi / 4.0, 1e-4);
}

}  // namespace
}  // namespace lambent::baker::reference
