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

TEST(AssetsShapes, ALatheIsClosedAndHoldsTheVolumeOfItsCone) {
  const glm::vec2 cone[] = {{0, 0}, {1, 0}, {0, 3}};
  const Mesh mesh = lathe(cone, 128, 0.25f);
  expectSound(mesh, "cone");
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_NEAR(volume(mesh), kPi, 0.001 * kPi);
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
