// Tests the look-up, compiled as C++.

#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/effects/neighborhood/neighborhood_kernels.hpp"

namespace lambent::effects::neighborhood {

namespace {

struct Written : glsl::Lookup {
  GridPlace grid;
};

// Fills every output with a linear function of the place, different for each slab.
glm::vec4 linear(const glm::vec3& point, uint slab) {
  const float o = static_cast<float>(slab);
  return {1.0f + o + point.x, 2.0f - o * point.y, point.z - 3.0f * o, 0.5f * o + 0.25f * point.x};
}

Written written(const glm::uvec3& size, std::uint32_t outputs, std::uint32_t max_side) {
  const GridShape shape{.size = size, .outputs = outputs};
  const AtlasLayout layout = layOutAtlas(std::span(&shape, 1), max_side);
  Written result{{.atlas = glsl::Texels(layout.size)}, layout.places[0]};
  result.grid.scale = 4.0f;
  std::vector<glm::vec4> samples;
  for (uint z = 0; z < size.z; ++z)
    for (uint y = 0; y < size.y; ++y)
      for (uint x = 0; x < size.x; ++x)
        for (uint o = 0; o < outputs; ++o) samples.push_back(linear(glm::vec3(x, y, z), o));
  glsl::write(result.atlas,
              {.grid = result.grid,
               .first_output = 0,
               .first_point = 0,
               .point_count = size.x * size.y * size.z,
               .pad = 0},
              samples);
  return result;
}

}  // namespace

TEST(NeighborhoodLookup, LooksUpLinearChangesExactlyAndNeverAcrossSlabs) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (const std::uint32_t max_side : {2048u, 20u}) {  // in one column, in several
    Written at = written({5, 4, 3}, 9, max_side);
    for (int i = 0; i < 200; ++i) {
      const glm::vec3 place =
          glm::vec3(4, 3, 2) * glm::vec3(uniform(random), uniform(random), uniform(random));
      for (uint o = 0; o < 9; ++o) {
        const glm::vec4 wanted = linear(place, o), got = at.gridOutput(place, at.grid, o);
        for (int c = 0; c < 4; ++c) EXPECT_NEAR(got[c], wanted[c], 2e-2f) << "half floats, slab " << o;
      }
    }
    // Faces themselves: the outermost points and nothing of a neighbour.
    for (uint o = 0; o < 9; ++o) {
      EXPECT_NEAR(at.gridOutput(glm::vec3(0.0f), at.grid, o).r, linear(glm::vec3(0.0f), o).r, 1e-2f);
      EXPECT_NEAR(at.gridOutput(glm::vec3(9.0f), at.grid, o).r, linear(glm::vec3(4, 3, 2), o).r, 1e-2f);
    }
  }
}

TEST(NeighborhoodLookup, FadesSmoothlyOverTheLastCellToNothingAtTheFaces) {
  glsl::Lookup at;
  GridPlace grid{};
  grid.size_x = 6;
  grid.size_y = 2;
  grid.size_z = 9;
  EXPECT_EQ(at.gridShare({2.5f, 0.5f, 4.0f}, grid), 1.0f) << "a grid of two points rises to its middle";
  EXPECT_EQ(at.gridShare({1.0f, 0.5f, 8.0f}, grid), 0.0f);
  EXPECT_EQ(at.gridShare({-1.0f, 0.5f, 4.0f}, grid), 0.0f);
  EXPECT_EQ(at.gridShare({5.0f, 0.5f, 4.0f}, grid), 0.0f);
  EXPECT_FLOAT_EQ(at.gridShare({4.5f, 0.5f, 4.0f}, grid), 0.5f);
  EXPECT_EQ(at.gridShare({4.0f, 0.5f, 1.0f}, grid), 1.0f);
  float before = 0.0f;
  for (int i = 0; i <= 500; ++i) {
    const float share = at.gridShare({0.01f * static_cast<float>(i), 0.5f, 4.0f}, grid);
    EXPECT_LE(std::abs(share - before), 0.0151f);
    before = share;
  }
}

TEST(NeighborhoodLookup, ReceivesAsTransferVectorsDo) {
  std::mt19937 random(4);
  std::normal_distribution<float> normal;
  Written at = written({4, 4, 4}, 9, 2048);
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 n = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    const glm::vec3 place(1.3f, 0.4f, 2.2f);
    std::vector<float> transfer(9);
    sh::unoccludedTransfer(3, n, transfer);
    glm::vec3 wanted(0.0f);
    for (uint o = 0; o < 9; ++o) wanted += transfer[o] * glm::vec3(at.gridOutput(place, at.grid, o));
    const glm::vec3 got = at.gridIrradiance(place, at.grid, n);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 1e-4f);
  }
}

TEST(NeighborhoodLookup, AChangeTakesNoLightThatIsNotThere) {
  EXPECT_EQ(glsl::Lookup().withChange({1, 1, 1}, {-0.5f, -1.0f, -2.0f}), glm::vec3(0.5f, 0.0f, 0.0f));
  EXPECT_EQ(glsl::Lookup().withChange({-0.1f, -0.1f, 0.0f}, {-1.0f, 1.0f, 0.5f}),
            glm::vec3(-0.1f, 0.9f, 0.5f));
  EXPECT_EQ(glsl::Lookup().withChange({-0.1f, 1.0f, 0.0f}, {0.0f, 0.0f, 0.0f}), glm::vec3(-0.1f, 1.0f, 0.0f))
      << "at the border nothing happens, not even to what coding errors made negative";
}

}  // namespace lambent::effects::neighborhood
