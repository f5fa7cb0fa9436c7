// Tests that faces are filled with triangles that keep to their outline and to the cuts through them.
#include "baker/refine/face_grid.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/refine/triangulation.hpp"

namespace lambent::baker {
namespace {

double areaOf(const FaceMesh& mesh, const glm::uvec3& t) {
  return 0.5 * cross(mesh.points[t.y] - mesh.points[t.x], mesh.points[t.z] - mesh.points[t.x]);
}

double areaOf(const FaceMesh& mesh) {
  double area = 0.0;
  for (const glm::uvec3& t : mesh.triangles) area += areaOf(mesh, t);
  return area;
}

// An L of 4 x 4 m less 2 x 2 m, with a hole of 0.5 x 0.5 m.
Outline lWithHole() {
  return {.points = {{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 4}, {0, 4}, {0.5, 0.5}, {1, 0.5}, {1, 1}, {0.5, 1}},
          .edges = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}, {6, 7}, {7, 8}, {8, 9}, {9, 6}}};
}

GridRules rules() {
  return {.inside = 0.5,
          .along = 0.125,
          .beside = 0.001,
          .scale = [](const glm::dvec2&) { return 1.0; },
          .seen = [](const glm::dvec2&) { return 1.0; }};
}

TEST(Triangulation, HasNoPointInACircleAndNoEdgeAcrossOneThatItMustHave) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    // Few places make many points of one line and one circle.
    const int reach = seed % 3 == 0 ? 4 : seed % 3 == 1 ? 50 : 1 << 25;
    std::uniform_int_distribution<int> place(-reach, reach);
    Triangulation triangulation;
    std::vector<std::uint32_t> points;
    for (const glm::ivec2 corner :
         {glm::ivec2(-1, -1), glm::ivec2(1, -1), glm::ivec2(1, 1), glm::ivec2(-1, 1)})
      points.push_back(triangulation.add(corner * (reach + 1)));
    for (int i = 0; i < 40; ++i) points.push_back(triangulation.add({place(random), place(random)}));
    for (std::size_t i = 0; i < 4; ++i)
      ASSERT_TRUE(triangulation.constrain(points[i], points[(i + 1) % 4], true));
    const auto delaunay = triangulation.inside();
    double area = 0.0;
    const auto at = [&](std::uint32_t p) { return glm::dvec2(triangulation.at(p)); };
    for (const glm::uvec3& t : delaunay) {
      const double twice = cross(at(t.y) - at(t.x), at(t.z) - at(t.x));
      EXPECT_GT(twice, 0.0);
      area += 0.5 * twice;
      const glm::dvec2 b = at(t.y) - at(t.x), c = at(t.z) - at(t.x);
      const glm::dvec2 middle = glm::dvec2(c.y * glm::dot(b, b) - b.y * glm::dot(c, c),
                                           b.x * glm::dot(c, c) - c.x * glm::dot(b, b)) /
                                (2.0 * twice);
      for (const std::uint32_t p : points)
        EXPECT_GT(glm::distance(at(p), at(t.x) + middle), glm::length(middle) * (1.0 - 1e-9));
    }
    EXPECT_DOUBLE_EQ(area, 4.0 * (reach + 1.0) * (reach + 1.0));
    const std::uint32_t from = points[4], to = points[5];
    if (from == to) continue;
    ASSERT_TRUE(triangulation.constrain(from, to, false));
    // No edge crosses the way.
    const auto crosses = [&](std::uint32_t p, std::uint32_t q) {
      const glm::dvec2 way = at(to) - at(from), edge = at(q) - at(p);
      return cross(way, at(p) - at(from)) * cross(way, at(q) - at(from)) < 0.0 &&
             cross(edge, at(from) - at(p)) * cross(edge, at(to) - at(p)) < 0.0;
    };
    for (const glm::uvec3& t : triangulation.inside())
      EXPECT_FALSE(crosses(t.x, t.y) || crosses(t.y, t.z) || crosses(t.z, t.x));
  }
}

TEST(FaceGrid, CoversItsOutlineAndNothingElse) {
  const GridRules grid = rules();
  for (const GridRules* with : {static_cast<const GridRules*>(nullptr), &grid}) {
    const auto mesh = fillOutline(lWithHole(), {}, with);
    ASSERT_TRUE(mesh);
    EXPECT_NEAR(areaOf(*mesh), 12.0 - 0.25, 1e-6);
    for (const glm::uvec3& t : mesh->triangles) EXPECT_GT(areaOf(*mesh, t), 0.0);
    EXPECT_EQ(mesh->points.size() > 40, with != nullptr);
  }
}

// Tools leave edges that end on the middle of others.
TEST(FaceGrid, CoversFacesThatMeetAlongPartsOfAnEdge) {
  const auto mesh =
      fillOutline({.points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}, {2, 2}, {0, 2}, {1, 1}},
                   .edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {2, 4}, {4, 5}, {5, 3}, {3, 6}, {6, 2}}},
                  {}, nullptr);
  ASSERT_TRUE(mesh);
  EXPECT_NEAR(areaOf(*mesh), 4.0, 1e-6);
}

TEST(FaceGrid, HasNoTriangleOnBothSidesOfACut) {
  const double at = 0.7137;
  const Line cut{{-1.0, at}, {5.0, at}};
  const GridRules grid = rules();
  const auto mesh = fillOutline(lWithHole(), std::span(&cut, 1), &grid);
  ASSERT_TRUE(mesh);
  double across = 0.0;
  for (const glm::uvec3& t : mesh->triangles) {
    const auto [low, high] = std::minmax({mesh->points[t.x].y, mesh->points[t.y].y, mesh->points[t.z].y});
    if (low < at - 0.002 && high > at + 0.002) across += areaOf(*mesh, t);
  }
  EXPECT_LT(across, 1e-2) << "of 12 m^2, where the cut ends at edges of the rim, which are long here";
}

TEST(FaceGrid, IsNoneOfAnOutlineThatCrossesItselfOrIsOpen) {
  EXPECT_FALSE(fillOutline(
      {.points = {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, .edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}}}, {}, nullptr));
  const GridRules grid = rules();
  EXPECT_FALSE(fillOutline({}, {}, &grid));
  const auto open =
      fillOutline({.points = {{0, 0}, {1, 0}, {1, 1}}, .edges = {{0, 1}, {1, 2}, {1, 2}, {1, 2}}}, {}, &grid);
  EXPECT_TRUE(open && open->triangles.empty());
}

}  // namespace
}  // namespace lambent::baker
