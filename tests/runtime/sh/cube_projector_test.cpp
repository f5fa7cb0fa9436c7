#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/projection.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"
#include "tests/support/differences.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

using testing::kDegree;

TEST(ShCubeProjector, FoldsToTheSameSumAsThePlainTable) {
  Random random(16);
  for (int size : {1, 2, 3, 4, 5, 8, 16, 17, 32})
    for (int order : {1, 2, 5, 6, 8}) {
      const auto texel_count = static_cast<std::size_t>(6 * size * size);
      std::vector<glm::vec3> texels;
      for (std::size_t k = 0; k < texel_count; ++k)
        texels.emplace_back(random.uniform(), random.uniform(), random.uniform());
      const std::vector<float> weights = cubeWeights(order, size);
      const LightVector light = CubeProjector(order, size).project(texels);
      for (std::size_t i = 0; i < light.coefficients().size(); ++i) {
        glm::dvec3 sum(0);
        for (std::size_t k = 0; k < texel_count; ++k)
          sum += static_cast<double>(weights[i * texel_count + k]) * glm::dvec3(texels[k]);
        // Sums of up to 6144 terms of about 4pi/6144 in float.
        for (int channel = 0; channel < 3; ++channel)
          ASSERT_NEAR(static_cast<double>(light.c[i][channel]), sum[channel], 1e-5)
              << "size " << size << ", order " << order << ", coefficient " << i;
      }
    }
}

TEST(ShCubeProjector, SeesEachTexelInItsDirection) {
  constexpr int kSize = 16;
  const CubeProjector projector(5, kSize);
  for (int face = 0; face < 6; ++face) {
    std::vector<glm::vec3> texels(6 * kSize * kSize, glm::vec3(0));
    texels[static_cast<std::size_t>((face * kSize + 2) * kSize + 11)] = glm::vec3(0, 1, 0);
    const LightVector light = projector.project(texels);
    const glm::dvec3 dir = cubeTexelDirection(kSize, face, 11, 2);
    std::array<double, 25> y;
    evaluate(5, dir, y);
    const double solid_angle = cubeTexelSolidAngle(kSize, 11, 2);
    for (std::size_t i = 0; i < 25; ++i) {
      EXPECT_NEAR(static_cast<double>(light.c[i].g), solid_angle * y[i], 0.03 * solid_angle)
          << face << ", " << i;
      EXPECT_EQ(light.c[i].r, 0);
    }
  }
}

TEST(ShCubeProjector, MakesAConstantMapConstantLight) {
  for (int size : {1, 5, 8, 16}) {
    const std::vector<glm::vec3> texels(static_cast<std::size_t>(6 * size * size), glm::vec3(1, 2, 3));
    const LightVector light = CubeProjector(6, size).project(texels);
    const LightVector expected = constantLight(6, {1, 2, 3});
    for (std::size_t i = 0; i < 36; ++i)
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(light.c[i][channel], expected.c[i][channel], 1e-5f) << size << ", " << i;
  }
}

// Fills each texel with the fraction that the disc covers, by 8 x 8 points weighted by solid angle.
std::vector<glm::vec3> discCapture(int size, const glm::dvec3& axis, double radius_rad) {
  constexpr int kPoints = 8;
  std::vector<glm::vec3> texels;
  const double reach = std::cos(std::min(std::numbers::pi, radius_rad + 2.0 / size));
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        double covered = 0, all = 0;
        if (glm::dot(cubeTexelDirection(size, face, x, y), axis) > reach)
          for (int b = 0; b < kPoints; ++b)
            for (int a = 0; a < kPoints; ++a) {
              const glm::dvec3 dir = cubeFaceDirection(face, 2 * (x + (a + 0.5) / kPoints) / size - 1,
                                                       2 * (y + (b + 0.5) / kPoints) / size - 1);
              const double length = glm::length(dir), area = 1 / (length * length * length);
              all += area;
              if (glm::dot(dir, axis) > length * std::cos(radius_rad)) covered += area;
            }
        texels.emplace_back(all > 0 ? covered / all : 0.0);
      }
  return texels;
}

struct CaptureError {
  double average = 0, worst = 0;
};

// Returns the squared relative error of the coefficients, in per cent, over 150 random directions.
std::array<CaptureError, 2> captureErrors(int order, int size, double degrees) {
  const CubeProjector projector(order, size);
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  Random random(17);
  std::array<CaptureError, 2> errors;  // ours; the centre of each texel times its solid angle
  constexpr int kDirections = 150;
  std::array<double, kMaxCoefficients> y;
  for (int k = 0; k < kDirections; ++k) {
    const glm::dvec3 axis = random.direction();
    const auto texels = discCapture(size, axis, degrees * kDegree);
    const LightVector exact = discLight(order, glm::vec3(axis), degrees * kDegree, {1, 1, 1});
    const LightVector ours = projector.project(texels);
    std::vector<double> centre(count);
    for (int texel = 0; texel < 6 * size * size; ++texel) {
      const double value = static_cast<double>(texels[static_cast<std::size_t>(texel)].r);
      if (value == 0) continue;
      const int x = texel % size, row = texel / size % size, face = texel / (size * size);
      evaluate(order, cubeTexelDirection(size, face, x, row), y);
      for (std::size_t i = 0; i < count; ++i) centre[i] += value * cubeTexelSolidAngle(size, x, row) * y[i];
    }
    std::array<double, 2> squared{};
    double norm = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double expected = static_cast<double>(exact.c[i].r);
      norm += expected * expected;
      squared[0] += std::pow(static_cast<double>(ours.c[i].r) - expected, 2);
      squared[1] += std::pow(centre[i] - expected, 2);
    }
    for (std::size_t which = 0; which < 2; ++which) {
      errors[which].average += 100 * squared[which] / norm / kDirections;
      errors[which].worst = lambent::testing::larger(errors[which].worst, 100 * squared[which] / norm);
    }
  }
  return errors;
}

// These are rows of the literature's table for box-filtered texels read at their centres, 150 random
// directions: averages vary by a tenth, maxima by more. The table checks the capture, and bounds the
// projector.
TEST(ShCubeProjector, CapturesDiscsBetterThanTexelCentresDo) {
  struct Row {
    int order, size;
    double degrees, average, worst;
  };
  for (const Row& row : {Row{5, 16, 5, .023, .14}, Row{6, 16, 5, .031, .15}, Row{5, 16, 20, .003, .008},
                         Row{6, 16, 20, .005, .016}, Row{5, 8, 10, .10, .59}}) {
    const auto [ours, centre] = captureErrors(row.order, row.size, row.degrees);
    EXPECT_NEAR(centre.average / row.average, 1, 0.2)
        << "order " << row.order << ", size " << row.size << ", disc " << row.degrees;
    EXPECT_LE(ours.average, row.average);
    EXPECT_LE(ours.worst, row.worst);
    EXPECT_LT(ours.average, centre.average);
  }
}

}  // namespace
}  // namespace lambent::sh
