#include "baker/transport/samples.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "baker/transport/group_geometry.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {

namespace {

using testing::box;
using testing::grid;
using testing::sceneOf;
using testing::Transport;

TEST(Samples, AreSharedByVerticesOfOnePositionAndNormal) {
  // Two grids side by side share an edge of 5 vertices; the box has 8 corners with three normals each.
  const auto left = grid({0, 0, 0}, 1.0f, 4), right = grid({1, 0, 0}, 1.0f, 4);
  EXPECT_EQ(Transport(sceneOf({left, right})).samples.size(), 25u + 20u);
  EXPECT_EQ(Transport(sceneOf({box({0, 0, 0}, {1, 1, 1}, 1)})).samples.size(), 24u);
}

TEST(Samples, KeepEveryVertexWhereItIs) {
  const Transport t(sceneOf({box({1, 2, 3}, {1, 2, 3}, 3)}));
  for (std::size_t v = 0; v < t.geometry.positions.size(); ++v) {
    EXPECT_EQ(t.samples.positions[t.samples.vertex_sample[v]], t.geometry.positions[v]);
    EXPECT_EQ(t.samples.normals[t.samples.vertex_sample[v]], t.geometry.normals[v]);
  }
}

TEST(Samples, StandOnTheirFacesWithWeightsThatSumToOne) {
  for (const float scale : {1e-3f, 1.0f, 1e4f}) {
    const Transport t(sceneOf({box(glm::vec3(scale), glm::vec3(scale), 2)}));
    for (std::size_t s = 0; s < t.samples.size(); ++s) {
      float sum = 0.0f;
      ASSERT_FALSE(t.samples.originsOf(s).empty());
      for (const SampleOrigin& origin : t.samples.originsOf(s)) {
        sum += origin.weight;
        const float height = glm::dot(origin.position - t.samples.positions[s], origin.geometric_normal);
        EXPECT_GT(height, 0.0f);
        EXPECT_LT(height, 1e-3f * scale);
      }
      EXPECT_NEAR(sum, 1.0f, 1e-5f);
    }
  }
}

TEST(Samples, AreCutIntoCellsOfAtMost64Ki) {
  const Transport t(sceneOf({grid({0, 0, 0}, 1.0f, 300)}));  // 90,601 samples
  ASSERT_EQ(t.samples.cells.size(), 2u);
  EXPECT_EQ(t.samples.cells[0].count, kMaxCellSamples);
  EXPECT_EQ(t.samples.cells[1].first, kMaxCellSamples);
  EXPECT_EQ(t.samples.cells[0].count + t.samples.cells[1].count, t.samples.size());
}

TEST(Samples, OfACellStandInTheOrderInWhichVerticesUseThem) {
  const Transport t(sceneOf({grid({0, 0, 0}, 1.0f, 64)}));
  for (std::uint32_t v = 0; v < t.samples.size(); ++v) EXPECT_EQ(t.samples.vertex_sample[v], v);
}

TEST(Samples, OfLargeGroupsAreCutIntoCompactCells) {
  const Transport t(sceneOf({grid({0, 0, 0}, 1.0f, 300)}));
  const SampleCell& last = t.samples.cells[1];
  // The last cell has 24,537 of 90,601 samples along a Morton curve: a corner, not a stripe over the whole.
  EXPECT_LT((last.bounds_max.x - last.bounds_min.x) * (last.bounds_max.z - last.bounds_min.z), 0.55f);
}

TEST(Samples, OfNormalMappedDrawsComeLastInCellsOfTheirOwn) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 2), grid({0, 0, 0}, 1.0f, 2)});
  testing::ownMaterial(scene, 0).normal_texture.texture = 0;
  const Transport t(scene);
  // The grids coincide, but what they store differs.
  EXPECT_EQ(t.samples.size(), 18u);
  EXPECT_EQ(t.samples.normal_mapped.begin, 9u);
  ASSERT_EQ(t.samples.cells.size(), 2u);
  EXPECT_EQ(t.samples.cells[0].kind, SampleKind::Diffuse);
  EXPECT_EQ(t.samples.cells[1].kind, SampleKind::NormalMapped);
  EXPECT_GE(t.samples.vertex_sample[0], 9u);  // the first mesh has the map
  EXPECT_LT(t.samples.vertex_sample[9], 9u);
}

TEST(SampleEdges, AreThoseOfTheTriangles) {
  const Transport t(sceneOf({grid({0, 0, 0}, 1.0f, 3)}));
  const auto edges = sampleEdges(t.geometry, t.samples);
  EXPECT_EQ(edges.size(), 2u * 3 * 4 + 9);  // sides of the cells and their diagonals
  EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
}

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

// Alpha masks are sampled with KHR_texture_transform applied.
TEST(GroupGeometry, TexcoordsAreThoseOfTheTransformedBaseColorTexture) {
  Scene scene = testing::sceneOf({testing::grid({0, 0, 0}, 1.0f, 1)});
  scene.materials[0].base_color_texture = {
      .texture = 0, .offset = {0.5f, -1.0f}, .scale = {2.0f, 4.0f}, .rotation_rad = 1.57079632f};
  const bundle::MeshData& mesh = scene.meshes[0].primitives[0].mesh;
  const auto geometry = buildGroupGeometry(findRigidGroups(scene).at(0), scene, {{mesh}});
  ASSERT_EQ(geometry.texcoords.size(), mesh.texcoords0.size());
  for (std::size_t v = 0; v < mesh.texcoords0.size(); ++v) {
    // A quarter turn takes (u, v) to (v, -u), as the extension writes its matrix.
    const glm::vec2 uv = mesh.texcoords0[v];
    EXPECT_NEAR(geometry.texcoords[v].x, 0.5f + 4.0f * uv.y, 1e-6f);
    EXPECT_NEAR(geometry.texcoords[v].y, -1.0f - 2.0f * uv.x, 1e-6f);
  }
}

// A mirroring node flips the bitangent, and so does the back, whose normal is negated; the direction in which
// the surface is brushed stays.
TEST(GroupGeometry, GivesGlossyDrawsTangentsAndBothSetsOfTexcoords) {
  bundle::MeshData mesh = testing::grid({0, 0, 0}, 1.0f, 1);
  mesh.tangents.assign(mesh.positions.size(), {1.0f, 0.0f, 0.0f, 1.0f});
  for (const glm::vec2& uv : mesh.texcoords0) mesh.texcoords1.push_back(3.0f * uv);
  for (const float mirror : {1.0f, -1.0f}) {
    Scene scene = testing::sceneOf({mesh});
    scene.materials[0].metallic = 1.0f;
    scene.materials[0].double_sided = true;
    scene.nodes[0].parent_from_node = glm::scale(glm::mat4(1.0f), glm::vec3(1.0f, 1.0f, 2.0f * mirror));
    const auto geometry =
        buildGroupGeometry(findRigidGroups(scene).at(0), scene, {{mesh}}, /*with_glossy=*/true);
    ASSERT_EQ(geometry.draws.size(), 2u);
    ASSERT_EQ(geometry.tangents.size(), geometry.positions.size());
    for (const DrawGeometry& draw : geometry.draws)
      for (std::size_t v = 0; v < draw.vertex_count; ++v) {
        const std::size_t at = draw.first_vertex + v;
        EXPECT_EQ(geometry.texcoord_sets[0][at], mesh.texcoords0[v]);
        EXPECT_EQ(geometry.texcoord_sets[1][at], mesh.texcoords1[v]);
        const glm::vec4 tangent = geometry.tangents[at];
        EXPECT_EQ(glm::vec3(tangent), glm::vec3(1.0f, 0.0f, 0.0f));
        // In the mesh cross(+Y, +X) = -Z; the node may take that to +Z.
        EXPECT_EQ(tangent.w * glm::cross(geometry.normals[at], glm::vec3(tangent)),
                  glm::vec3(0.0f, 0.0f, -mirror));
      }
  }
}

TEST(GroupGeometry, OfMatteScenesCarriesNothingForGlossyOnes) {
  bundle::MeshData mesh = testing::grid({0, 0, 0}, 1.0f, 1);
  const Scene scene = testing::sceneOf({mesh});
  const auto geometry =
      buildGroupGeometry(findRigidGroups(scene).at(0), scene, {{mesh}}, /*with_glossy=*/true);
  EXPECT_TRUE(geometry.tangents.empty());
  EXPECT_TRUE(geometry.texcoord_sets[0].empty());
}

}  // namespace
}  // namespace lambent::baker
