#include "runtime/sh/image_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"
#include "tests/support/differences.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

using testing::kDegree;

struct Shape {
  ImageLayout layout;
  int width, height;
};
constexpr std::array<Shape, 3> kShapes = {{{ImageLayout::LatLong, 128, 64},
                                           {ImageLayout::AngularMap, 100, 100},
                                           {ImageLayout::VerticalCross, 48, 64}}};

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}
void expectAt(ImageLayout layout, int width, int height, const glm::dvec3& dir, double x, double y) {
  const glm::dvec2 at = imageCoordinates(layout, width, height, dir);
  EXPECT_NEAR(at.x, x, 1e-9);
  EXPECT_NEAR(at.y, y, 1e-9);
}

TEST(ShImageLayout, CoversTheSphereOnce) {
  for (const Shape& shape : kShapes) {
    double sum = 0;
    for (int y = 0; y < shape.height; ++y)
      for (int x = 0; x < shape.width; ++x)
        sum += texelSolidAngle(shape.layout, shape.width, shape.height, x, y);
    const double tolerance =
        shape.layout == ImageLayout::AngularMap ? 3.0 / (shape.width * shape.width) : 1e-12;
    EXPECT_NEAR(sum / (4 * std::numbers::pi), 1, tolerance) << name(shape.layout);
  }
}

TEST(ShImageLayout, LooksUpTheTexelThatADirectionCameFrom) {
  for (const Shape& shape : kShapes)
    for (int y = 0; y < shape.height; ++y)
      for (int x = 0; x < shape.width; ++x) {
        const glm::dvec3 dir = texelDirection(shape.layout, shape.width, shape.height, x, y);
        if (texelSolidAngle(shape.layout, shape.width, shape.height, x, y) == 0) {
          EXPECT_EQ(dir, glm::dvec3(0));
          continue;
        }
        EXPECT_NEAR(glm::length(dir), 1, 1e-14);
        const glm::dvec2 at = imageCoordinates(shape.layout, shape.width, shape.height, 3.0 * dir);
        ASSERT_NEAR(at.x, x + 0.5, 1e-9) << name(shape.layout) << " " << x << ", " << y;
        ASSERT_NEAR(at.y, y + 0.5, 1e-9) << name(shape.layout) << " " << x << ", " << y;
      }
}

TEST(ShImageLayout, PutsAxesWhereTheConventionsSay) {
  expectAt(ImageLayout::LatLong, 200, 100, {1, 0, 0}, 100, 50);  // the centre
  expectAt(ImageLayout::LatLong, 200, 100, {0, 0, 1}, 150, 50);  // right of it
  expectAt(ImageLayout::LatLong, 200, 100, {0, 0, -1}, 50, 50);
  EXPECT_NEAR(imageCoordinates(ImageLayout::LatLong, 200, 100, {0, 1, 0}).y, 0, 1e-12);
  EXPECT_NEAR(imageCoordinates(ImageLayout::LatLong, 200, 100, {0, -1, 0}).y, 100, 1e-12);
  expectAt(ImageLayout::AngularMap, 100, 100, {0, 0, -1}, 50, 50);
  expectAt(ImageLayout::AngularMap, 100, 100, {1, 0, 0}, 75, 50);
  expectAt(ImageLayout::AngularMap, 100, 100, {0, 1, 0}, 50, 25);
  expectAt(ImageLayout::AngularMap, 100, 100, {0, 0, 1}, 100, 50);  // the rim, at its right end
  expectAt(ImageLayout::VerticalCross, 30, 40, {0, 1, 0}, 15, 5);
  expectAt(ImageLayout::VerticalCross, 30, 40, {-1, 0, 0}, 5, 15);
  expectAt(ImageLayout::VerticalCross, 30, 40, {0, 0, -1}, 15, 15);
  expectAt(ImageLayout::VerticalCross, 30, 40, {1, 0, 0}, 25, 15);
  expectAt(ImageLayout::VerticalCross, 30, 40, {0, -1, 0}, 15, 25);
  expectAt(ImageLayout::VerticalCross, 30, 40, {0, 0, 1}, 15, 35);
}

// A walk down the middle column crosses four square edges; successive directions must stay close.
TEST(ShImageLayout, FoldsTheCrossWithoutTears) {
  constexpr int kSize = 64;
  glm::dvec3 before = texelDirection(ImageLayout::VerticalCross, 3 * kSize, 4 * kSize, 3 * kSize / 2, 0);
  for (int y = 1; y < 4 * kSize; ++y) {
    const glm::dvec3 dir = texelDirection(ImageLayout::VerticalCross, 3 * kSize, 4 * kSize, 3 * kSize / 2, y);
    EXPECT_LT(glm::distance(dir, before), 2.1 / kSize) << y;
    before = dir;
  }
  before = texelDirection(ImageLayout::VerticalCross, 3 * kSize, 4 * kSize, 0, kSize + 7);
  for (int x = 1; x < 3 * kSize; ++x) {
    const glm::dvec3 dir = texelDirection(ImageLayout::VerticalCross, 3 * kSize, 4 * kSize, x, kSize + 7);
    EXPECT_LT(glm::distance(dir, before), 2.1 / kSize) << x;
    before = dir;
  }
}

// This is the table of OpenGL 4.5, section 8.13: sc, tc, ma of each face.
TEST(ShCubeMap, HasOpenGlsFaces) {
  Random random(15);
  for (int k = 0; k < 100; ++k) {
    const glm::dvec3 r = random.direction();
    const glm::dvec3 a = glm::abs(r);
    int face = 0;
    double sc = 0, tc = 0, ma = 0;
    if (a.x >= a.y && a.x >= a.z) {
      face = r.x > 0 ? 0 : 1, ma = a.x, sc = r.x > 0 ? -r.z : r.z, tc = -r.y;
    } else if (a.y >= a.z) {
      face = r.y > 0 ? 2 : 3, ma = a.y, sc = r.x, tc = r.y > 0 ? r.z : -r.z;
    } else {
      face = r.z > 0 ? 4 : 5, ma = a.z, sc = r.z > 0 ? r.x : -r.x, tc = -r.y;
    }
    expectNear(glm::normalize(cubeFaceDirection(face, sc / ma, tc / ma)), r, 1e-14);
  }
}

TEST(ShCubeMap, CoversTheSphereAtEverySize) {
  for (int size : {1, 4, 5, 16, 64}) {
    double sum = 0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) sum += 6 * cubeTexelSolidAngle(size, x, y);
    EXPECT_NEAR(sum, 4 * std::numbers::pi, 1e-12) << size;
  }
}

LightVector projected(int order, const std::vector<float>& weights, const std::vector<glm::vec3>& texels) {
  LightVector light{.order = order};
  for (std::size_t i = 0; i < light.coefficients().size(); ++i) {
    glm::dvec3 sum(0);
    for (std::size_t k = 0; k < texels.size(); ++k)
      sum += static_cast<double>(weights[i * texels.size() + k]) * glm::dvec3(texels[k]);
    light.c[i] = glm::vec3(sum);
  }
  return light;
}

TEST(ShCubeMap, WeightsMakeAConstantMapConstantLight) {
  for (int size : {1, 5, 8, 16}) {
    const std::vector<glm::vec3> texels(static_cast<std::size_t>(6 * size * size), glm::vec3(1, 2, 3));
    const LightVector light = projected(6, cubeWeights(6, size), texels);
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
  const std::vector<float> weights = cubeWeights(order, size);
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  Random random(17);
  std::array<CaptureError, 2> errors;  // ours; the centre of each texel times its solid angle
  constexpr int kDirections = 150;
  std::array<double, kMaxCoefficients> y;
  for (int k = 0; k < kDirections; ++k) {
    const glm::dvec3 axis = random.direction();
    const auto texels = discCapture(size, axis, degrees * kDegree);
    const LightVector exact = discLight(order, glm::vec3(axis), degrees * kDegree, {1, 1, 1});
    const LightVector ours = projected(order, weights, texels);
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
// weights.
TEST(ShCubeMap, WeightsCaptureDiscsBetterThanTexelCentresDo) {
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

struct PictureShape {
  ImageLayout layout;
  int width, height;
  double tolerance;  // of a constant picture's other coefficients: the layout's quadrature, O(1/width²)
};
constexpr PictureShape kPictureShapes[] = {{ImageLayout::LatLong, 512, 256, 2e-4},
                                           {ImageLayout::AngularMap, 400, 400, 2e-4},
                                           {ImageLayout::VerticalCross, 384, 512, 2e-4}};

std::vector<glm::vec3> picture(const PictureShape& shape, const LightVector& light) {
  std::vector<glm::vec3> texels;
  for (int y = 0; y < shape.height; ++y)
    for (int x = 0; x < shape.width; ++x)
      texels.push_back(
          light.evaluate(glm::vec3(texelDirection(shape.layout, shape.width, shape.height, x, y))));
  return texels;
}

TEST(ShProjection, GivesBackABandLimitedLight) {
  const LightVector light = discLight(6, {0.6f, 0.48f, 0.64f}, 0.5, {3, 1, 2}) + constantLight(6, {1, 1, 1});
  for (const PictureShape& shape : kPictureShapes) {
    const LightVector back = projectImage(6, shape.layout, shape.width, shape.height, picture(shape, light));
    for (std::size_t i = 0; i < 36; ++i)
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(back.c[i][channel], light.c[i][channel], 5 * shape.tolerance)
            << name(shape.layout) << " " << i;
  }
}

TEST(ShProjection, ReplacesWhatIsNotLight) {
  std::vector<glm::vec3> texels(64 * 32, glm::vec3(1));
  std::vector<glm::vec3> mended = texels;
  const float infinity = std::numeric_limits<float>::infinity();
  texels[5].g = std::numeric_limits<float>::quiet_NaN();
  texels[700].r = infinity;
  texels[701].b = -infinity;
  for (int k : {5, 700, 701}) mended[static_cast<std::size_t>(k)] = glm::vec3(0);
  texels[900].r = mended[900].r = -1;
  texels[1000] = mended[1000] = glm::vec3(1e30f);

  const LightVector light = projectImage(5, ImageLayout::LatLong, 64, 32, texels);
  const LightVector expected = projectImage(5, ImageLayout::LatLong, 64, 32, mended);
  for (std::size_t i = 0; i < 25; ++i) EXPECT_EQ(light.c[i], expected.c[i]);
}

}  // namespace
}  // namespace lambent::sh
