#include "baker/transport/face_points.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::Transport;

std::vector<std::uint32_t> allTriangles(const GroupGeometry& geometry) {
  std::vector<std::uint32_t> all(geometry.triangles.size());
  for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
  return all;
}

TEST(FacePoints, StandInTheMiddleOfTheirFacesAndOffThem) {
  const Transport t(testing::sceneOf({testing::icosphere({0.0f, 0.0f, 0.0f}, 1.0f, 2)}));
  const FacePoints points = facePoints(t.geometry, t.samples, allTriangles(t.geometry));
  ASSERT_EQ(points.samples.size(), t.geometry.triangles.size());
  EXPECT_EQ(points.samples.glossy.begin, points.samples.size());  // none is glossy
  for (std::size_t p = 0; p < points.samples.size(); ++p) {
    const glm::uvec3 corners = t.geometry.triangles[points.triangles[p]];
    const glm::vec3 middle = (t.geometry.positions[corners.x] + t.geometry.positions[corners.y] +
                              t.geometry.positions[corners.z]) /
                             3.0f;
    EXPECT_LT(glm::distance(points.samples.positions[p], middle), 1e-6f);
    EXPECT_NEAR(glm::length(points.samples.normals[p]), 1.0f, 1e-6f);
    ASSERT_EQ(points.samples.originsOf(p).size(), 1u);
    const SampleOrigin& origin = points.samples.originsOf(p)[0];
    EXPECT_GT(glm::dot(origin.position - middle, origin.geometric_normal), 0.0f);
  }
}

TEST(FacePoints, OfAFoldHaveNoOrigin) {
  bundle::MeshData mesh = testing::grid({0.0f, 0.0f, 0.0f}, 1.0f, 1);
  for (glm::vec3& normal : mesh.normals) normal = -normal;  // faces turn their backs to their normals
  const Transport t(testing::sceneOf({mesh}));
  const FacePoints points = facePoints(t.geometry, t.samples, allTriangles(t.geometry));
  ASSERT_EQ(points.samples.size(), 2u);
  EXPECT_TRUE(points.samples.origins.empty());
}

}  // namespace
}  // namespace lambent::baker
