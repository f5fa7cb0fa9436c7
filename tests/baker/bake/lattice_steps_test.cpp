// Tests that small things keep their shapes on the way to disk beside large ones.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "baker/bake/ship_meshes.hpp"
#include "baker/import/details.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::grid;
using testing::icosphere;
using testing::sceneOf;

Meshes shipped(const Scene& scene) {
  Progress progress;
  const std::vector<RigidGroup> groups = findRigidGroups(scene);
  auto out = shipMeshes(scene, groups, *splitMeshes(scene, groups, 0.0f), {progress});
  EXPECT_TRUE(out) << out.error().line();
  return out ? std::move(out->decoded) : Meshes{};
}

// Returns whether each vertex of the mesh has one of the other within this distance.
bool isNear(const bundle::MeshData& mesh, const bundle::MeshData& decoded, float distance) {
  return std::ranges::all_of(mesh.positions, [&](const glm::vec3& p) {
    return std::ranges::any_of(decoded.positions,
                               [&](const glm::vec3& q) { return glm::distance(p, q) < distance; });
  });
}

TEST(LatticeSteps, ABallKeepsItsShapeOnAGroundOfTenKilometres) {
  for (const float radius : {0.5f, 0.005f}) {
    const bundle::MeshData ground = grid({0, 0, 0}, 1e4f, 1), ball = icosphere({0, radius, 0}, radius, 3);
    const float edge = detailOf(ball);
    EXPECT_GT(edge, 0.05f * radius);
    const Meshes apart = shipped(sceneOf({ground, ball}));
    EXPECT_EQ(apart[1][0].indices.size(), ball.indices.size());
    EXPECT_TRUE(isNear(ball, apart[1][0], 5e-4f * edge)) << radius << " in a mesh of its own";

    Scene scene = sceneOf({testing::joined(ground, ball)});
    separateDetails(scene.meshes[0]);
    const Meshes joined = shipped(scene);
    ASSERT_EQ(joined[0].size(), 2u);
    EXPECT_EQ(joined[0][0].indices.size(), ground.indices.size());
    EXPECT_EQ(joined[0][1].indices.size(), ball.indices.size());
    EXPECT_TRUE(isNear(ball, joined[0][1], 5e-4f * edge)) << radius << " joined with the ground";
  }
}

TEST(LatticeSteps, OpenNoSeamBetweenAFineGridAndACoarseOne) {
  // A field of 8 km beside a yard of 30 m, with a corner in common at no round number.
  const glm::vec3 corner(0.1234567f, 0.7654321f, 0.3333333f);
  const bundle::MeshData field = grid(corner + glm::vec3(-4000, 0, -4000), 8000.0f, 2),
                         yard = grid(corner + glm::vec3(15, 0, 15), 30.0f, 60);
  const auto corners = [&](const bundle::MeshData& mesh) {
    return std::ranges::count_if(mesh.positions, [&](const glm::vec3& p) { return p == corner; });
  };
  Scene scene = sceneOf({field, yard});
  scene.meshes[0].primitives[0].mesh.positions.back() = corner;
  scene.meshes[1].primitives[0].mesh.positions.front() = corner;
  ASSERT_EQ(corners(scene.meshes[0].primitives[0].mesh), 1);
  const auto steps = latticeSteps(scene, findRigidGroups(scene));
  ASSERT_LT(steps[1][0], steps[0][0]);
  const Meshes out = shipped(scene);
  const auto meets = [&](const glm::vec3& p) {
    return std::ranges::find(out[1][0].positions, p) != out[1][0].positions.end();
  };
  EXPECT_EQ(std::ranges::count_if(out[0][0].positions, meets), 1);
}

TEST(LatticeSteps, AreThoseOfTheGroupWhereTheseKeepShapes) {
  Scene scene = sceneOf({grid({0, 0, 0}, 8.0f, 4), icosphere({1, 0.3f, 0}, 0.3f, 4)});
  const auto steps = latticeSteps(scene, findRigidGroups(scene));
  EXPECT_EQ(steps[0][0], std::ldexp(1.0f, -15));
  EXPECT_EQ(steps[1][0], steps[0][0]);
  separateDetails(scene.meshes[1]);
  EXPECT_EQ(scene.meshes[1].primitives.size(), 1u);
}

}  // namespace
}  // namespace lambent::baker
