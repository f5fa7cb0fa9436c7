#include "runtime/light_plan/light_plan.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace lambent::frame {

namespace {

lighting::LocalLight pointAt(const glm::vec3& place) {
  return {.kind = lighting::LocalLight::Kind::Point, .position_ws = place, .power = glm::vec3(1.0f)};
}

TEST(ShadowedLightChoice, WithinTheBoundsALightIsNoRadiiAway) {
  const scene::Box box{{-1, -2, -2}, {1, 2, 2}};  // radius 3
  EXPECT_EQ(radiiFrom(box, glm::mat4(1.0f), pointAt({0.9f, 1.9f, -1.9f})), 0.0f);
  EXPECT_NEAR(radiiFrom(box, glm::mat4(1.0f), pointAt({1.1f, 0, 0})), 1.1f / 3.0f, 1e-6f);
  EXPECT_NEAR(radiiFrom(box, glm::mat4(1.0f), pointAt({0, 9, 0})), 3.0f, 1e-6f);
  lighting::LocalLight sphere = pointAt({0, 9, 0});
  sphere.kind = lighting::LocalLight::Kind::Sphere;
  sphere.radius_m = 3.0f;
  EXPECT_NEAR(radiiFrom(box, glm::mat4(1.0f), sphere), 2.0f, 1e-6f) << "to where it begins";
  sphere.radius_m = 8.0f;
  EXPECT_EQ(radiiFrom(box, glm::mat4(1.0f), sphere), 0.0f) << "it reaches in";
}

TEST(ShadowedLightChoice, RadiiAreThoseOfTheBodyAsItStands) {
  const scene::Box box{glm::vec3(-1), glm::vec3(1)};
  const glm::mat4 place = glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(5, 0, 0)), glm::vec3(0.5f));
  EXPECT_NEAR(radiiFrom(box, place, pointAt({5, 0, 3})), 3.0f / (0.5f * std::sqrt(3.0f)), 1e-5f);
  EXPECT_TRUE(std::isinf(radiiFrom(scene::Box{}, place, pointAt({5, 0, 3}))));
  lighting::LocalLight sun = pointAt({5, 0, 0});
  sun.kind = lighting::LocalLight::Kind::Directional;
  EXPECT_TRUE(std::isinf(radiiFrom(box, place, sun)));
  EXPECT_TRUE(std::isinf(radiiFrom(box, place, pointAt({NAN, 0, 0}))));
}

TEST(ShadowedLightChoice, TheShareFallsOnTheWayOut) {
  const std::vector<float> from = {0.0f, 4.9f, 5.5f, 6.0f, 7.0f};
  const std::vector<float> shares = localShares(from, 6.0f);
  EXPECT_EQ(shares[0], 1.0f);
  EXPECT_EQ(shares[1], 1.0f);
  EXPECT_NEAR(shares[2], 0.5f, 1e-6f);
  EXPECT_EQ(shares[3], 0.0f);
  EXPECT_EQ(shares[4], 0.0f);
}

TEST(ShadowedLightChoice, WithoutRadiiOnlyLightsWithinBoundsShinePerPixel) {
  const std::vector<float> from = {0.1f, 0.0f, 2.0f};
  EXPECT_EQ(localShares(from, 0.0f), (std::vector<float>{0.0f, 1.0f, 0.0f}));
}

TEST(ShadowedLightChoice, OfManyLightsWithinBoundsTheFirstHaveThePlaces) {
  std::vector<float> from(lighting::kMaxShadowedLights + 2, 0.0f), expected(from.size(), 1.0f);
  from.front() = 0.5f;
  expected.front() = expected.back() = 0.0f;
  EXPECT_EQ(localShares(from, 6.0f), expected);
}

TEST(ShadowedLightChoice, NoMoreShineThanThereAreShadowCubesForAndNoneJumps) {
  // Eleven lights move to and fro, and change their order all the time.
  const auto at = [](int step) {
    std::vector<float> from;
    for (int k = 0; k < 11; ++k)
      from.push_back(3.5f +
                     3.0f * std::sin(0.002f * static_cast<float>(step * (k + 2)) + static_cast<float>(k)));
    return from;
  };
  std::vector<float> before = localShares(at(0), 6.0f);
  int changes = 0;
  for (int step = 1; step < 3000; ++step) {
    const std::vector<float> now = localShares(at(step), 6.0f);
    EXPECT_LE(std::ranges::count_if(now, [](float share) { return share > 0.0f; }),
              static_cast<std::ptrdiff_t>(lighting::kMaxShadowedLights));
    for (std::size_t k = 0; k < now.size(); ++k) {
      // A light moves by at most 0.054 radii per step, relative to a sixth of the nearest limit.
      ASSERT_NEAR(now[k], before[k], 0.3f) << "step " << step << ", light " << k;
      changes += (now[k] > 0.0f) != (before[k] > 0.0f) ? 1 : 0;
    }
    before = now;
  }
  EXPECT_GT(changes, 20);
}

ColumnLight columnOf(std::vector<float> radii_m, float radiance) {
  ColumnLight light;
  for (const float radius : radii_m)
    light.shapes.push_back(
        {.kind = lighting::LocalLight::Kind::Sphere, .radius_m = radius, .power = glm::vec3(radiance)});
  return light;
}

TEST(ColumnLightChoice, TheBrightestGetTheCubesAsFarAsAllTheirShapesFit) {
  EXPECT_NEAR(intensityOf(columnOf({2.0f}, 3.0f).shapes[0]), 12.0f * std::numbers::pi_v<float>, 1e-4f);
  const std::vector<ColumnLight> lights = {columnOf({0.1f}, 10.0f), columnOf({0.1f, 0.1f, 0.1f}, 9.0f),
                                           columnOf({0.2f}, 10.0f)};
  using Chosen = std::vector<std::size_t>;
  const std::vector<float> effects = effectsOf(World(), lights);
  EXPECT_EQ(chooseColumnLights(lights, effects, 5), (Chosen{0, 1, 2}));
  EXPECT_EQ(chooseColumnLights(lights, effects, 4), (Chosen{1, 2}));
  EXPECT_EQ(chooseColumnLights(lights, effects, 3), (Chosen{0, 2}))
      << "two cubes are too few for three spheres";
  EXPECT_EQ(chooseColumnLights(lights, effects, 1), (Chosen{2}));
  EXPECT_EQ(chooseColumnLights(lights, effects, 0), Chosen());
}

TEST(ColumnLightChoice, ALightKeepsItsCubeUntilAnotherBringsClearlyMore) {
  std::vector<ColumnLight> lights = {columnOf({0.1f}, 1.0f), columnOf({0.1f}, 1.0f)};
  for (std::uint32_t i = 0; i < 2; ++i) lights[i].entity = {.index = i, .generation = 1};
  std::vector<ecs::Entity> chosen;
  std::vector<std::size_t> steps;
  // What the second brings rises past the first and falls back.
  for (const float effect : {0.9f, 1.2f, 1.4f, 1.6f, 1.2f, 0.9f, 0.6f}) {
    const std::vector<std::size_t> now =
        chooseColumnLights(lights, std::vector<float>{1.0f, effect}, 1, chosen);
    chosen = {lights[now.at(0)].entity};
    steps.push_back(now[0]);
  }
  EXPECT_EQ(steps, (std::vector<std::size_t>{0, 0, 0, 1, 1, 1, 0}));
}

}  // namespace

}  // namespace lambent::frame
