// Tests that invisible faces of scanned models do not darken what is visible.
#include <array>
#include <bit>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::grid;
using testing::joined;
using testing::sceneOf;
using testing::Transport;
using testing::upright;

// Makes a sliver just above the floor, seen from behind, with the floor's normals.
bundle::MeshData sliver() {
  bundle::MeshData mesh;
  mesh.positions = {{-0.1f, 0.001f, 0}, {0.1f, 0.001f, 0}, {0, 0.001f, 0.05f}};
  mesh.normals.assign(3, {0, 1, 0});
  mesh.indices = {0, 1, 2};
  return mesh;
}

std::size_t blockedRays(const Transport& t, const glm::vec3& place) {
  const SampleOrigin origin{place, {0, 1, 0}, 1.0f};
  const DirectionTable table = cosineTable(256);
  std::vector<std::uint16_t> masks(table.packets());
  t.rays.trace({std::span(&origin, 1), upright(), table}, masks);
  std::size_t blocked = 0;
  for (const std::uint16_t mask : masks) blocked += static_cast<std::size_t>(std::popcount(mask));
  return blocked;
}

TEST(Folds, BlockNoRays) {
  const Transport t(sceneOf({joined(grid({0, 0, 0}, 1.0f, 4), sliver())}));
  EXPECT_EQ(findFlippedFaces(t.geometry).back(), 1);
  EXPECT_EQ(blockedRays(t, {0, 1e-4f, 0.02f}), 0u);
}

TEST(Folds, AreNoneWhereAllOfASurfaceIsTurnedOver) {
  // In such a file either the normals or the faces are wrong.
  bundle::MeshData roof = grid({0, 1, 0}, 1e4f, 2);
  for (glm::vec3& n : roof.normals) n = -n;
  EXPECT_EQ(blockedRays(Transport(sceneOf({roof})), {0, 0, 0}), 256u);
}

TEST(Folds, HaveNoOriginsOfTheSamplesAtTheirCorners) {
  // A corner of the sliver is one of the floor's too.
  bundle::MeshData mesh = joined(grid({0, 0, 0}, 1.0f, 4), sliver());
  mesh.positions[mesh.positions.size() - 3] = {0, 0, 0};
  const Transport t(sceneOf({mesh}));
  const auto origins = t.samples.originsOf(t.sampleAt({0, 0, 0}));
  EXPECT_EQ(origins.size(), 6u);
  for (const SampleOrigin& origin : origins) EXPECT_GT(origin.geometric_normal.y, 0.0f);
}

TEST(SeenOrigins, LeaveOutWhatSomethingLiesOn) {
  // A slab lies on half of a floor, a hair above it.
  const Transport t(sceneOf({grid({0, 0, 0}, 4.0f, 4), box({1.0f, 0.051f, 0}, {2.0f, 0.1f, 4.0f}, 1)}));
  const SampleOrigin covered{{0.5f, 1e-4f, 0}, {0, 1, 0}, 0.5f, 0.1f},
      seen{{-0.5f, 1e-4f, 0}, {0, 1, 0}, 0.5f, 0.1f};
  const InsideTestTables glances;
  SeenOrigins found;
  findSeenOrigins(std::array{covered, seen}, upright(), t.rays, glances, found);
  ASSERT_TRUE(found.valid);
  ASSERT_EQ(found.origins.size(), 1u);
  EXPECT_EQ(found.origins[0].position, seen.position);
  EXPECT_EQ(found.origins[0].weight, 1.0f);
  findSeenOrigins(std::span(&covered, 1), upright(), t.rays, glances, found);
  EXPECT_FALSE(found.valid);
  // A surface as far off as the ceiling of a room does not hide it.
  const SampleOrigin indoors{{0.5f, 1e-4f, 0}, {0, 1, 0}, 1.0f, 1e-5f};
  findSeenOrigins(std::span(&indoors, 1), upright(), t.rays, glances, found);
  EXPECT_TRUE(found.valid);
}

TEST(SeenOrigins, LeaveOutWhatAThinWallHidesFromTheVertex) {
  const Transport t(sceneOf({grid({0, 0, 0}, 4.0f, 4), box({0.05f, 0.5f, 0}, {0.02f, 1.0f, 4.0f}, 1)}));
  // The vertex is (0, 0, 0); origins stand 3 % of the way to the middles of their faces.
  const SampleOrigin here{{-0.03f, 1e-4f, 0}, {0, 1, 0}, 0.25f, 0.1f, {-0.97f, 0, 0}},
      beyond{{0.12f, 1e-4f, 0}, {0, 1, 0}, 0.75f, 0.1f, {3.88f, 0, 0}};
  const InsideTestTables glances;
  SeenOrigins found;
  findSeenOrigins(std::array{here, beyond}, upright(), t.rays, glances, found);
  ASSERT_TRUE(found.valid);
  ASSERT_EQ(found.origins.size(), 1u);
  EXPECT_EQ(found.origins[0].position, here.position);
  EXPECT_EQ(found.origins[0].weight, 1.0f);
  findSeenOrigins(std::span(&beyond, 1), upright(), t.rays, glances, found);
  EXPECT_TRUE(found.valid);
}

TEST(SeenOrigins, AreJudgedByAllRaysHoweverSmallTheirFaceIs) {
  // Rays that are dealt out by weight leave none for the face that is a sliver at the vertex, and what no ray
  // tests would pass as seen.
  const Transport t(sceneOf({grid({0, 0, 0}, 4.0f, 4), box({1.0f, 0.051f, 0}, {2.0f, 0.1f, 4.0f}, 1)}));
  const SampleOrigin wide{{0.5f, 1e-4f, 0}, {0, 1, 0}, 0.999f, 0.1f},
      narrow{{0.6f, 1e-4f, 0}, {0, 1, 0}, 0.001f, 0.1f};
  SeenOrigins found;
  findSeenOrigins(std::array{wide, narrow}, upright(), t.rays, InsideTestTables(), found);
  EXPECT_FALSE(found.valid);
}

TEST(SeenOrigins, MoveIntoTheFaceWhereItsVertexIsCovered) {
  const Transport t(sceneOf({grid({0, 0, 0}, 4.0f, 4), box({1.0f, 0.051f, 0}, {2.0f, 0.1f, 4.0f}, 1)}));
  const SampleOrigin covered{{0.5f, 1e-4f, 0}, {0, 1, 0}, 1.0f, 0.1f, {-1.5f, 0, 0}};
  SeenOrigins found;
  findSeenOrigins(std::span(&covered, 1), upright(), t.rays, InsideTestTables(), found);
  ASSERT_TRUE(found.valid);
  EXPECT_LT(found.origins[0].position.x, 0.0f);
  EXPECT_EQ(found.origins[0].weight, 1.0f);
}

}  // namespace
}  // namespace lambent::baker
