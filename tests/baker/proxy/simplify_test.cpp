#include "baker/proxy/simplify.hpp"

#include <numeric>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/proxy/shine.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::sceneOf;
using testing::Transport;

SimpleMesh whole(const GroupGeometry& geometry) {
  std::vector<std::uint32_t> all(geometry.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return welded(geometry, all);
}

float meshArea(const SimpleMesh& mesh) {
  float sum = 0.0f;
  for (const glm::uvec3& t : mesh.triangles)
    sum += 0.5f * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                         mesh.positions[t.z] - mesh.positions[t.x]));
  return sum;
}

TEST(Simplified, KeepsFlatFacesExactly) {
  const Transport t(sceneOf({testing::box({1, 2, 3}, {2, 1, 4}, 12)}));
  const SimpleMesh mesh = simplified(whole(t.geometry), 12);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_FLOAT_EQ(meshArea(mesh), 28.0f);
  EXPECT_LT(mesh.error_m, 1e-3f);
}

TEST(Simplified, HasNoMoreTrianglesThanAskedForWhateverTheShape) {
  for (const auto& body : {testing::icosphere({0, 0, 0}, 1.0f, 4), testing::soup(7, 0.3f, 0.0f),
                           testing::grid({0, 0, 0}, 2.0f, 40)}) {
    const Transport t(sceneOf({body}));
    const SimpleMesh all = whole(t.geometry);
    for (const std::size_t most : {4u, 16u, 64u, 256u}) {
      const SimpleMesh mesh = simplified(all, most);
      EXPECT_LE(mesh.triangles.size(), most);
      EXPECT_GE(mesh.triangles.size(), 1u);
      EXPECT_TRUE(std::isfinite(mesh.error_m));
      for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) EXPECT_LT(triangle[corner], mesh.positions.size());
    }
  }
}

TEST(Silhouette, TellsByHowMuchABodyMustGrow) {
  const Transport t(sceneOf({testing::icosphere({0, 0, 0}, 1.0f, 4)}));
  const std::vector<SimpleMesh> body = {whole(t.geometry)};
  std::vector<SimpleMesh> smaller = body;
  for (glm::vec3& p : smaller[0].positions) p *= 0.8f;
  const Silhouette silhouette(body);
  EXPECT_EQ(silhouette.scaleOf(body), 1.0f);
  EXPECT_NEAR(silhouette.scaleOf(smaller), 1.25f, 0.01f);
  EXPECT_EQ(silhouette.scaleOf({}), 1.0f);
  EXPECT_EQ(Silhouette({}).scaleOf(body), 1.0f);
}

TEST(PointsOn, StandForEqualPartsOfTheArea) {
  const Transport t(
      sceneOf({testing::joined(testing::grid({0, 0, 0}, 1.0f, 2), testing::grid({9, 0, 0}, 3.0f, 1))}));
  std::vector<std::uint32_t> all(t.geometry.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  double small = 0.0, sum = 0.0, u = 0.0;
  const auto points = pointsOn(t.geometry, all, 2000);
  for (const SurfacePoint& point : points) {
    sum += double{point.area}, small += point.triangle < 8 ? double{point.area} : 0.0;
    u += double{point.u} / static_cast<double>(points.size());
    EXPECT_GE(std::min(point.u, point.v), 0.0f);
    EXPECT_LE(point.u + point.v, 1.0f);
  }
  EXPECT_NEAR(sum, 10.0, 1e-4);
  EXPECT_NEAR(small, 1.0, 0.01);
  EXPECT_NEAR(u, 1.0 / 3.0, 0.005);
}

}  // namespace
}  // namespace lambent::baker
