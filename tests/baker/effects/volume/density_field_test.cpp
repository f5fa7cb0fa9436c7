// Compares optical depth along rays with closed forms and with plain ray marching.
#include <numbers>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/baker/effects/volume/media.hpp"

namespace lambent::baker {
namespace {

using testing::cube;
using testing::Fog;

constexpr float kFar = std::numeric_limits<float>::infinity();

TEST(DensityField, OfOneDensityHasTheDepthOfTheChord) {
  const Fog fog = cube(4.0f, 7);
  const glm::vec3 diagonal = glm::normalize(glm::vec3(1.0f));
  EXPECT_NEAR(fog.field->opticalDepth(glm::vec3(-2.0f), diagonal, kFar), 4.0f * std::sqrt(3.0f), 1e-4f);
  EXPECT_NEAR(fog.field->opticalDepth(glm::vec3(0.0f), {0, 0, 1}, kFar), 2.0f, 1e-5f);
  EXPECT_NEAR(fog.field->opticalDepth(glm::vec3(0.0f), {0, 0, 1}, 0.25f), 1.0f, 1e-5f);
  EXPECT_NEAR(fog.field->opticalDepth({-3, 0.1f, 0.2f}, {1, 0, 0}, 2.75f), 1.0f, 1e-4f);
  EXPECT_EQ(fog.field->opticalDepth({-3, 0.6f, 0.0f}, {1, 0, 0}, kFar), 0.0f);   // beside it
  EXPECT_EQ(fog.field->opticalDepth({-3, 0.0f, 0.0f}, {-1, 0, 0}, kFar), 0.0f);  // away from it
}

TEST(DensityField, IsLinearBetweenCentresAndConstantInTheHalfVoxelsAtItsFaces) {
  const Fog fog({2, 1, 1}, {0, 0, 0}, {2, 1, 1}, [](glm::vec3 p) { return p.x < 1.0f ? 1.0f : 3.0f; });
  EXPECT_EQ(fog.field->atGrid({0.2f, 0.9f, 0.1f}), 1.0f);
  EXPECT_EQ(fog.field->atGrid({1.0f, 0.5f, 0.5f}), 2.0f);
  EXPECT_EQ(fog.field->atGrid({1.75f, 0.5f, 0.5f}), 3.0f);
  EXPECT_EQ(fog.field->atGrid({2.1f, 0.5f, 0.5f}), 0.0f);
  EXPECT_NEAR(fog.field->opticalDepth({0, 0.5f, 0.5f}, {1, 0, 0}, kFar), 0.5f + 2.0f + 1.5f, 1e-5f);
}

// Makes a rotated, stretched box that is mostly empty, with clumps: many blocks, many of them empty.
TEST(DensityField, GivesWhatFineStepsGiveInAnyDirection) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  const glm::uvec3 size(29, 18, 37);
  std::vector<float> values(29 * 18 * 37, 0.0f);
  for (std::size_t v = 0; v < values.size(); v += 1 + (v * v) % 41)
    if ((v / 500) % 3 == 0) values[v] = 2.0f + unit(random);
  const glm::mat4 group_from_grid = glm::scale(
      glm::rotate(glm::translate(glm::mat4(1.0f), {1, 2, 3}), 0.7f, glm::normalize(glm::vec3(1, 2, 3))),
      {0.1f, 0.2f, 0.05f});
  const DensityField field(size, values, group_from_grid);
  for (int i = 0; i < 40; ++i) {
    const glm::vec3 direction = i < 3 ? glm::vec3(i == 0, i == 1, i == 2)
                                      : glm::normalize(glm::vec3(unit(random), unit(random), unit(random)));
    const glm::vec3 target(group_from_grid * glm::vec4(14.5f + 10.0f * unit(random),
                                                       9.0f + 6.0f * unit(random),
                                                       18.5f + 12.0f * unit(random), 1.0f));
    const glm::vec3 origin = i % 2 == 0 ? target : target - 5.0f * direction;
    double sum = 0.0;
    constexpr int kSteps = 40000;
    constexpr double kStep = 12.0 / kSteps;
    for (int k = 0; k < kSteps; ++k)
      sum += kStep * double{field.atGrid(
                         field.gridFromGroup(origin + static_cast<float>((k + 0.5) * kStep) * direction))};
    EXPECT_NEAR(double{field.opticalDepth(origin, direction, 12.0f)}, sum, 2e-3 * std::max(1.0, sum)) << i;
  }
}

TEST(DensityField, StretchesAreNoLongerThanAskedForAndAddUp) {
  const Fog fog = cube(2.0f, 3);
  float sum = 0.0f, reached = 0.0f;
  const glm::vec3 direction = glm::normalize(glm::vec3(1, 0.3f, -0.2f));
  fog.field->march(
      glm::vec3(0.0f), direction, kFar, [](float) { return 0.03f; },
      [&](float from, float to, float depth) {
        EXPECT_NEAR(from, reached, 1e-6f);
        EXPECT_LE(to - from, 0.0301f);
        EXPECT_NEAR(depth, 2.0f * (to - from), 1e-6f);
        reached = to;
        sum += depth;
        return true;
      });
  EXPECT_NEAR(sum, fog.field->opticalDepth(glm::vec3(0.0f), direction, kFar), 1e-5f);
}

TEST(DensityField, TakesExtremes) {
  EXPECT_EQ(cube(0.0f, 4).field->opticalDepth(glm::vec3(0.0f), {1, 0, 0}, kFar), 0.0f);
  EXPECT_NEAR(cube(1e-6f, 4).field->opticalDepth(glm::vec3(0.0f), {1, 0, 0}, kFar), 0.5e-6f, 1e-11f);
  const float thick = cube(1e12f, 4).field->opticalDepth(glm::vec3(0.0f), {1, 0, 0}, kFar);
  EXPECT_GT(thick, kOpaqueDepth);
  EXPECT_TRUE(std::isfinite(thick));
}

}  // namespace
}  // namespace lambent::baker
