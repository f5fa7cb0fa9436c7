// Tests the packing of grids in one texture: nothing overlaps, nothing exceeds the texture.

#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "runtime/effects/neighborhood/neighborhood.hpp"

namespace lambent::effects::neighborhood {

namespace {

// Visits every texel of every slab once.
void expectDisjoint(std::span<const GridShape> shapes, const AtlasLayout& layout, std::uint32_t max_side) {
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> taken;
  std::size_t texels = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const GridPlace& place = layout.places[i];
    if (place.outputs == 0) continue;
    EXPECT_EQ(place.outputs, shapes[i].outputs);
    for (std::uint32_t o = 0; o < place.outputs; ++o)
      for (std::uint32_t z = 0; z < place.size_z; ++z)
        for (std::uint32_t y = 0; y < place.size_y; ++y) {
          const std::uint32_t at_y = place.first_y + place.size_y * (o / place.slabs_per_column) + y;
          const std::uint32_t at_z = place.first_z + place.size_z * (o % place.slabs_per_column) + z;
          taken.insert({at_y, at_z, 0});
          ++texels;
          EXPECT_LT(at_y, layout.size.y);
          EXPECT_LT(at_z, layout.size.z);
        }
    EXPECT_LE(place.size_x, layout.size.x);
  }
  EXPECT_EQ(taken.size(), texels) << "slabs overlap";
  EXPECT_LE(layout.size.x, max_side);
  EXPECT_LE(layout.size.y, max_side);
  EXPECT_LE(layout.size.z, max_side);
}

}  // namespace

TEST(NeighborhoodAtlas, OneGridTakesNoMoreThanItsPoints) {
  const GridShape shape{.size = {64, 64, 8}, .outputs = 9};
  const AtlasLayout layout = layOutAtlas(std::span(&shape, 1), 2048);
  EXPECT_EQ(layout.size, glm::uvec3(64, 64, 72));
  expectDisjoint(std::span(&shape, 1), layout, 2048);
}

TEST(NeighborhoodAtlas, ManyOutputsGoOnInAColumnBeside) {
  const GridShape shape{.size = {64, 8, 64}, .outputs = 36};  // 2304 texels deep
  const AtlasLayout layout = layOutAtlas(std::span(&shape, 1), 2048);
  EXPECT_EQ(layout.places[0].slabs_per_column, 32u);
  EXPECT_EQ(layout.size, glm::uvec3(64, 16, 2048));
  expectDisjoint(std::span(&shape, 1), layout, 2048);
}

TEST(NeighborhoodAtlas, RandomGridsNeverOverlap) {
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    std::vector<GridShape> shapes;
    for (int i = 0; i < 12; ++i)
      shapes.push_back({.size = {2 + random() % 9, 2 + random() % 9, 2 + random() % 9},
                        .outputs = std::array{9u, 16u, 25u, 36u}[random() % 4]});
    expectDisjoint(shapes, layOutAtlas(shapes, 100), 100);
  }
}

TEST(NeighborhoodAtlas, GridsWithoutRoomAreLeftOutAlone) {
  const std::vector<GridShape> shapes = {{.size = {200, 4, 4}, .outputs = 9},
                                         {.size = {4, 4, 4}, .outputs = 9},
                                         {.size = {8, 90, 8}, .outputs = 25},
                                         {.size = {8, 90, 8}, .outputs = 9}};
  const AtlasLayout layout = layOutAtlas(shapes, 100);
  EXPECT_EQ(layout.places[0].outputs, 0u) << "too wide";
  EXPECT_EQ(layout.places[1].outputs, 9u);
  expectDisjoint(shapes, layout, 100);
  EXPECT_EQ(layOutAtlas({}, 2048).size, glm::uvec3(0));
}

}  // namespace lambent::effects::neighborhood
