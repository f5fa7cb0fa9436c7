// Tests that rays meet in a tree of triangles what they meet one triangle at a time.
#include "runtime/lighting/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lambent::lighting {
namespace {

class Random {
 public:
  float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(source_); }
  glm::vec3 inBox(float half) { return {between(-half, half), between(-half, half), between(-half, half)}; }

 private:
  std::mt19937 source_{7};
};

std::vector<RayTriangle> manyTriangles(Random& random, std::size_t count) {
  std::vector<RayTriangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    // A few large ones lie among the small ones, as walls among ornaments.
    const float size = i % 50 == 0 ? 2.0f : 0.1f;
    const glm::vec3 at = random.inBox(1.0f);
    triangles.push_back(
        {{at, at + random.inBox(size), at + random.inBox(size)}, random.between(0.0f, 1.0f) < 0.3f});
  }
  return triangles;
}

// Returns the nearest of all triangles, each met in a tree of its own, and its distance.
std::optional<std::pair<std::uint32_t, float>> nearestOf(const std::vector<RayTriangle>& triangles,
                                                         const glm::vec3& origin,
                                                         const glm::vec3& direction) {
  std::optional<std::pair<std::uint32_t, float>> nearest;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto hit = TriangleTree({triangles[i]}, 0.0f).first(origin, direction);
    if (!hit) continue;
    const auto& [a, b, c] = triangles[i].corners;
    const float distance = glm::distance(origin, a + hit->b * (b - a) + hit->c * (c - a));
    if (!nearest || distance < nearest->second) nearest = {i, distance};
  }
  return nearest;
}

TEST(TriangleTree, FindsTheNearestOfManyAsOneByOne) {
  Random random;
  const std::vector<RayTriangle> triangles = manyTriangles(random, 1000);
  const TriangleTree tree(triangles, 0.0f);
  std::size_t hits = 0;
  for (int i = 0; i < 400; ++i) {
    const glm::vec3 origin = random.inBox(1.5f), direction = random.inBox(1.0f);
    const auto expected = nearestOf(triangles, origin, direction);
    const auto found = tree.first(origin, direction);
    ASSERT_EQ(found.has_value(), expected.has_value()) << i;
    if (!found) continue;
    ++hits;
    EXPECT_EQ(found->triangle, expected->first) << i;
    const float lengths = expected->second / glm::length(direction);
    EXPECT_TRUE(tree.blocked(origin, direction, 1.001f * lengths)) << i;
    EXPECT_FALSE(tree.blocked(origin, direction, 0.999f * lengths)) << i;
  }
  EXPECT_GT(hits, 100u);
}

TEST(TriangleTree, LetsNoRayOutOfAClosedBoxAlongAxesAndThroughEdges) {
  std::vector<RayTriangle> box;
  constexpr int kCells = 6;  // along an edge
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f})
      for (int u = 0; u < kCells; ++u)
        for (int v = 0; v < kCells; ++v) {
          const auto corner = [&](int i, int j) {
            glm::vec3 p(side);
            p[(axis + 1) % 3] = 2.0f * static_cast<float>(i) / kCells - 1.0f;
            p[(axis + 2) % 3] = 2.0f * static_cast<float>(j) / kCells - 1.0f;
            return p;
          };
          box.push_back({{corner(u, v), corner(u + 1, v), corner(u + 1, v + 1)}});
          box.push_back({{corner(u, v), corner(u + 1, v + 1), corner(u, v + 1)}});
        }
  const TriangleTree tree(box, 0.0f);
  for (int x = -6; x <= 6; ++x)
    for (int y = -6; y <= 6; ++y)
      for (int z = -6; z <= 6; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        EXPECT_TRUE(tree.first(glm::vec3(0.0f), {x, y, z})) << x << ' ' << y << ' ' << z;
      }
}

TEST(TriangleTree, OfASheetsTwoSidesTheOneThatFacesTheRayCounts) {
  Random random;
  const glm::vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  const TriangleTree tree({{{a, b, c}}, {{a, c, b}}}, 1e-5f);
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 at(random.between(0.1f, 0.4f), random.between(0.1f, 0.4f), 0.0f);
    for (const float side : {-1.0f, 1.0f}) {
      const glm::vec3 origin(random.between(0, 1), random.between(0, 1), side);
      const auto hit = tree.first(origin, at - origin);
      ASSERT_TRUE(hit);
      EXPECT_FALSE(hit->back);
      EXPECT_EQ(hit->triangle, side > 0.0f ? 0u : 1u);
    }
  }
  EXPECT_FALSE(tree.first({0.2f, 0.2f, 1e-6f}, {0, 0, -1}));  // it lies on the sheet
}

TEST(TriangleTree, FindsAllTrianglesNearAPoint) {
  Random random;
  const std::vector<RayTriangle> triangles = manyTriangles(random, 500);
  const TriangleTree tree(triangles, 0.0f);
  std::vector<std::uint32_t> found;
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 point = random.inBox(1.0f);
    tree.findNear(point, 0.2f, found);
    EXPECT_TRUE(std::ranges::is_sorted(found));
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const auto isNear = [&](const glm::vec3& corner) { return glm::distance(corner, point) < 0.2f; };
      if (std::ranges::none_of(triangles[t].corners, isNear)) continue;
      EXPECT_TRUE(std::ranges::binary_search(found, t)) << i << ' ' << t;
    }
  }
}

}  // namespace
}  // namespace lambent::lighting
