#include "runtime/sh/image_layout.hpp"

#include <array>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/runtime/sh/sphere.hpp"

namespace lambent::sh {
namespace {

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

TEST(ShImageLayout, PutsLatLongAxesWhereTheConventionsSay) {
  expectAt(ImageLayout::LatLong, 200, 100, {1, 0, 0}, 100, 50);  // the centre
  expectAt(ImageLayout::LatLong, 200, 100, {0, 0, 1}, 150, 50);  // right of it
  expectAt(ImageLayout::LatLong, 200, 100, {0, 0, -1}, 50, 50);
  EXPECT_NEAR(imageCoordinates(ImageLayout::LatLong, 200, 100, {0, 1, 0}).y, 0, 1e-12);
  EXPECT_NEAR(imageCoordinates(ImageLayout::LatLong, 200, 100, {0, -1, 0}).y, 100, 1e-12);
}

TEST(ShImageLayout, PutsAngularMapAxesWhereTheConventionsSay) {
  expectAt(ImageLayout::AngularMap, 100, 100, {0, 0, -1}, 50, 50);
  expectAt(ImageLayout::AngularMap, 100, 100, {1, 0, 0}, 75, 50);
  expectAt(ImageLayout::AngularMap, 100, 100, {0, 1, 0}, 50, 25);
  expectAt(ImageLayout::AngularMap, 100, 100, {0, 0, 1}, 100, 50);  // the rim, at its right end
}

TEST(ShImageLayout, PutsCrossSquaresWhereTheConventionsSay) {
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
  testing::Random random(15);
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

}  // namespace
}  // namespace lambent::sh
