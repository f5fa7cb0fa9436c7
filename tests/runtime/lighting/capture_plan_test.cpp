// Tests what the light capture decides without a GPU: tiles and pages.
#include "runtime/lighting/capture_plan.hpp"

#include <array>
#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/image_layout.hpp"
#include "tests/runtime/lighting/capture_scenes.hpp"

namespace lambent::lighting {

using testing::cubeProxy;
using testing::squareProxy;

TEST(CapturePlan, OnePointAloneAlwaysGetsAPage) {
  // Slabs in front of all faces, so that tiles are long and thin, at the largest size.
  const std::vector<capture::ProxyBounds> proxies = {capture::ProxyBounds::of(squareProxy())};
  std::vector<CaptureBody> bodies;
  for (std::uint32_t face = 0; face < 6; ++face)
    for (int strip = -2; strip <= 2; ++strip) {
      const glm::vec3 at(sh::cubeFaceDirection(static_cast<int>(face), 0, 0.38 * strip));
      bodies.push_back({0, glm::scale(glm::translate(glm::mat4(1), at),
                                      glm::vec3(0.15f + 0.1f * static_cast<float>(face)))});
    }
  const CaptureOptions options{.size = 64, .subsamples = 16};
  const capture::Plan plan = capture::plan(options, proxies, bodies, std::vector<CapturePoint>(3));
  EXPECT_EQ(plan.points.size(), 3u);
  for (const capture::Page& page : plan.pages) EXPECT_LT(page.height, 8192u);
}

TEST(CapturePlan, TilesAreApartAndInTheAtlas) {
  const std::vector<capture::ProxyBounds> proxies = {capture::ProxyBounds::of(cubeProxy())};
  std::mt19937 random(8);
  std::uniform_real_distribution<float> place(-9, 9);
  std::vector<CaptureBody> bodies;
  for (int i = 0; i < 30; ++i)
    bodies.push_back(
        {0, glm::translate(glm::mat4(1), glm::vec3(place(random), place(random), place(random)))});
  std::vector<CapturePoint> points(70);
  for (CapturePoint& p : points) p.position_ws = glm::vec3(place(random), place(random), place(random));
  const CaptureOptions options;
  const capture::Plan plan = capture::plan(options, proxies, bodies, points);
  EXPECT_GT(plan.pages.size(), 1u);
  std::uint32_t points_seen = 0, draws_seen = 0;
  for (const capture::Page& page : plan.pages) {
    EXPECT_LE(page.height, capture::kAtlasHeight);
    EXPECT_EQ(page.first_point, points_seen);
    EXPECT_EQ(page.first_draw, draws_seen);
    points_seen += page.point_count;
    draws_seen += page.draw_count;
    // Tiles begin at multiples of a texel.
    std::vector<bool> taken(capture::kAtlasWidth / 16 * capture::kAtlasHeight / 16);
    const auto& last = plan.points[page.first_point + page.point_count - 1];
    for (std::uint32_t t = plan.points[page.first_point].first_tile; t < last.first_tile + last.tile_count;
         ++t) {
      const capture::Tile& tile = plan.tiles[t];
      for (std::uint32_t y = 0; y < tile.texels.height(); ++y)
        for (std::uint32_t x = 0; x < tile.texels.width(); ++x) {
          const std::size_t at = (tile.y / 16 + y) * (capture::kAtlasWidth / 16) + tile.x / 16 + x;
          ASSERT_LT(tile.y + (y + 1) * 16, page.height + 1);
          ASSERT_LT(tile.x / 16 + x, capture::kAtlasWidth / 16);
          ASSERT_FALSE(taken[at]);
          taken[at] = true;
        }
    }
  }
  EXPECT_EQ(points_seen, plan.points.size());
  EXPECT_EQ(draws_seen, plan.draws.size());
}

}  // namespace lambent::lighting
