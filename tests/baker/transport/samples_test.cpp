#include "baker/transport/samples.hpp"

#include <algorithm>
#include <set>

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
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].normal_texture.texture = 0;
  scene.meshes[0].primitives[0].material = 1;
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

}  // namespace
}  // namespace lambent::baker
