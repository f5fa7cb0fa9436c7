// Checks that the shapes are valid, closed where they should be, and have the volumes of their formulas.
#include "assets/shapes.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/assets/mesh_checks.hpp"

namespace lambent::assets {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(AssetsShapes, ABoxIsClosedAndHoldsItsVolume) {
  const Mesh mesh = box({-1, 0, 2}, {1, 0.5f, 2.25f}, 0.1f);
  expectSound(mesh, "box");
  EXPECT_NEAR(volume(mesh), 2 * 0.5 * 0.25, 1e-5);
}

TEST(AssetsShapes, ASphereIsClosedAndNearlyHoldsItsVolume) {
  const Mesh mesh = sphere(0.5f, 24);
  expectSound(mesh, "sphere");
  EXPECT_NEAR(volume(mesh), kPi / 6, 0.002 * kPi / 6);  // chords of 3.75 degrees lose 0.15 %
}

TEST(AssetsShapes, ALatheIsClosedAndHoldsTheVolumeOfItsCone) {
  const glm::vec2 cone[] = {{0, 0}, {1, 0}, {0, 3}};
  const Mesh mesh = lathe(cone, 128, 0.25f);
  expectSound(mesh, "cone");
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_NEAR(volume(mesh), kPi, 0.001 * kPi);
}

TEST(AssetsShapes, ATorusKnotIsClosedAndHoldsLengthTimesSection) {
  const TorusKnot knot{.ring_radius = 0.36f,
                       .torus_radius = 0.16f,
                       .tube_radius = 0.05f,
                       .cells_along = 600,
                       .cells_around = 64};
  const Mesh mesh = torusKnot(knot);
  expectSound(mesh, "torus knot");
  EXPECT_TRUE(isClosed(mesh));
  // A tube's volume is its cross-section times the length of its centre line (Pappus).
  double length = 0.0;
  glm::dvec3 last(0.0);
  for (int i = 0; i <= 20000; ++i) {
    const double t = 2 * kPi * i / 20000, distance = 0.36 + 0.16 * std::cos(3 * t);
    const glm::dvec3 point(distance * std::sin(2 * t), 0.16 * std::sin(3 * t), distance * std::cos(2 * t));
    if (i > 0) length += glm::length(point - last);
    last = point;
  }
  EXPECT_NEAR(volume(mesh), kPi * 0.05 * 0.05 * length, 0.003 * kPi * 0.05 * 0.05 * length);
}

TEST(AssetsShapes, APlaneFacesEdgeUCrossEdgeVAndCountsMetres) {
  const Mesh mesh = plane({1, 2, 3}, {2, 0, 0}, {0, 0, -3}, 0.25f);
  expectSound(mesh, "plane");
  EXPECT_EQ(mesh.normals.front(), glm::vec3(0, 1, 0));
  EXPECT_EQ(mesh.positions.size(), 9u * 13u);
  EXPECT_EQ(mesh.texcoords.back(), glm::vec2(2, 3));
}

}  // namespace
}  // namespace lambent::assets
