// Tests that faces around a vertex that see different things get separate values, and only those.
#include "baker/refine/wedges.hpp"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace lambent::baker {
namespace {

// Makes six faces around star 0, of area 1, whose outer corners are stars 1..6.
FaceLacks ring(const std::array<float, 6>& values) {
  FaceLacks lacks{.width = 1};
  for (std::uint32_t f = 0; f < 6; ++f) {
    lacks.values.insert(lacks.values.end(), {values[f], values[f]});
    lacks.areas.push_back(1.0);
    lacks.corner_stars.insert(lacks.corner_stars.end(), {0u, 1 + f, 1 + (f + 1) % 6});
  }
  return lacks;
}

TEST(Wedges, PartFacesThatLackOppositeThings) {
  const Wedges fans = chooseWedges(ring({1, 1, 1, -1, -1, -1}), 7, 1e-3, 100);
  for (std::size_t plus = 0; plus < 3; ++plus)
    for (std::size_t minus = 3; minus < 6; ++minus)
      EXPECT_NE(fans.of_corner[3 * plus], fans.of_corner[3 * minus]) << plus << ", " << minus;
  EXPECT_NE(fans.of_corner[3 * 2 + 2], fans.of_corner[3 * 3 + 1]) << "at the star between faces 2 and 3";
  EXPECT_NE(fans.of_corner[3 * 5 + 2], fans.of_corner[1]) << "and between faces 5 and 0";
}

TEST(Wedges, AreNotNeededWhereOneValueServesAll) {
  const Wedges fans = chooseWedges(ring({1, 1, 1, 1, 1, 1}), 7, 1e-3, 100);
  EXPECT_EQ(fans.added, 0u);
}

TEST(Wedges, AreRunsOfNeighboursEvenWhereFartherFacesAreMoreAlike) {
  // Faces alternate between up and down, so no two adjacent ones are alike.
  const Wedges fans = chooseWedges(ring({1, -1, 1, -1, 1, -1}), 7, 0.0, 1);
  ASSERT_EQ(fans.added, 1u);
  int changes = 0;  // around the middle
  for (std::size_t f = 0; f < 6; ++f) changes += fans.of_corner[3 * f] != fans.of_corner[3 * ((f + 1) % 6)];
  EXPECT_LE(changes, 2);
}

TEST(Wedges, AreAsManyAsMayBeAddedAtMost) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  FaceLacks lacks = ring({});
  for (std::size_t f = 0; f < 6; ++f) lacks.values[2 * f] = lacks.values[2 * f + 1] = normal(random);
  for (const std::size_t most : {0u, 1u, 3u}) {
    const Wedges fans = chooseWedges(lacks, 7, 0.0, most);
    EXPECT_LE(fans.added, most);
    EXPECT_EQ(fans.of_corner.size(), 18u);
  }
}

// Makes two estimates with independent noise: their products are 0 on average, their squares are not.
TEST(Wedges, OfNoiseAreFewerThanOfWhatBothEstimatesShow) {
  constexpr std::size_t kWidth = 36;
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  FaceLacks noise = ring({}), both = ring({});
  noise.width = both.width = kWidth;
  noise.values.assign(6 * 2 * kWidth, 0.0f), both.values = noise.values;
  for (std::size_t f = 0; f < 6; ++f)
    for (std::size_t k = 0; k < kWidth; ++k) {
      noise.values[(2 * f) * kWidth + k] = normal(random);
      noise.values[(2 * f + 1) * kWidth + k] = normal(random);
      both.values[(2 * f) * kWidth + k] = both.values[(2 * f + 1) * kWidth + k] = normal(random);
    }
  // What is enough is half of what there is.
  EXPECT_LT(chooseWedges(noise, 7, 108.0, 100).added, chooseWedges(both, 7, 20.0, 100).added);
}

TEST(Wedges, GetVerticesOfTheirOwnAtTheSamePlace) {
  bundle::MeshData mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}};
  mesh.normals.assign(4, {0, 1, 0});
  mesh.texcoords0 = {{0, 0}, {1, 0}, {0, 1}, {2, 0}};
  mesh.indices = {0, 2, 1, 0, 3, 2};
  const std::vector<std::uint8_t> of_corner{0, 0, 0, 1, 0, 1};
  splitIntoWedges(mesh, of_corner);
  ASSERT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.normals.size(), 6u);
  EXPECT_EQ(mesh.texcoords0.size(), 6u);
  EXPECT_EQ(mesh.fans, (std::vector<std::uint8_t>{0, 0, 0, 0, 1, 1}));
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 2, 1, 4, 3, 5}));
  EXPECT_EQ(mesh.positions[4], mesh.positions[0]);
  EXPECT_EQ(mesh.texcoords0[5], mesh.texcoords0[2]);
}

TEST(Wedges, OfNothingLeaveTheMeshAsItIs) {
  bundle::MeshData mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  mesh.indices = {0, 2, 1};
  splitIntoWedges(mesh, std::vector<std::uint8_t>(3, 0));
  EXPECT_EQ(mesh.positions.size(), 3u);
  EXPECT_TRUE(mesh.fans.empty());
}

}  // namespace
}  // namespace lambent::baker
