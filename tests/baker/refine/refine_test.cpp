// Tests that vertices are added where shadows change and nowhere else, without cracks, and equally for any
// number of threads.
#include "baker/refine/refine.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/jobs/parallel.hpp"
#include "baker/refine/group_refiner.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::sceneOf;

using Meshes = std::vector<std::vector<bundle::MeshData>>;

struct Refined {
  RefineReport report;
  Meshes meshes;
};

Refined refined(const Scene& scene, const RefineOptions& options, bool with_glossy = false) {
  Refined result;
  for (const SceneMesh& mesh : scene.meshes) {
    result.meshes.emplace_back();
    for (const ScenePrimitive& primitive : mesh.primitives) result.meshes.back().push_back(primitive.mesh);
  }
  Progress progress;
  const auto groups = findRigidGroups(scene);
  DecodedImages images(scene);
  const std::vector<PlannedTransport> all_shadows(groups.size());
  const auto report =
      refineMeshes({scene, groups, all_shadows, with_glossy, images}, options, result.meshes, {progress});
  EXPECT_TRUE(report) << report.error().line();
  if (report) result.report = *report;
  return result;
}

// Makes a floor of two triangles, 4 x 4 m about the origin, and a slab of 1 m that floats half a metre above
// it.
Scene floorUnderSlab() {
  return sceneOf({grid({0, 0, 0}, 4.0f, 1), box({0.0f, 0.5f, 0.0f}, {1.0f, 0.05f, 1.0f}, 2)});
}

TEST(Refinement, LeavesWhatSeesAllOfTheSkyAsItIs) {
  for (const Scene& scene : {sceneOf({grid({0, 0, 0}, 4.0f, 2)}), sceneOf({box({0, 0, 0}, {1, 2, 3}, 2)})}) {
    const Refined result = refined(scene, {});
    EXPECT_EQ(result.report.vertices_after, result.report.vertices_before);
    EXPECT_LT(result.report.error_before, 1e-6);
  }
}

TEST(Refinement, BringsTheErrorUnderTheBoundWithVerticesWhereTheShadowFalls) {
  const Refined result = refined(floorUnderSlab(), {.bound = 0.02f});
  EXPECT_GT(result.report.error_before, 0.05);
  EXPECT_LT(result.report.error_after, 0.02);
  const bundle::MeshData& floor = result.meshes[0][0];
  EXPECT_GT(floor.positions.size(), 50u);
  EXPECT_EQ(floor.normals.size(), floor.positions.size());
  const auto within = [&](float reach) {
    return std::count_if(floor.positions.begin(), floor.positions.end(),
                         [&](const glm::vec3& p) { return std::max(std::abs(p.x), std::abs(p.z)) < reach; });
  };
  // A quarter of the floor's area has more than half of its vertices.
  EXPECT_GT(within(1.0f), static_cast<std::ptrdiff_t>(floor.positions.size()) / 2);
}

// Makes the same on the ground of a shaft: four walls as high as the floor is wide take most of the light,
// and of the shadow beside open light.
Scene floorInShaft(int wall_cells) {
  const Scene open = floorUnderSlab();
  return sceneOf({open.meshes[0].primitives[0].mesh, open.meshes[1].primitives[0].mesh,
                  box({-2.1f, 2.0f, 0.0f}, {0.1f, 4.0f, 4.2f}, wall_cells),
                  box({2.1f, 2.0f, 0.0f}, {0.1f, 4.0f, 4.2f}, wall_cells),
                  box({0.0f, 2.0f, -2.1f}, {4.2f, 4.0f, 0.1f}, wall_cells),
                  box({0.0f, 2.0f, 2.1f}, {4.2f, 4.0f, 0.1f}, wall_cells)});
}

TEST(Refinement, MeasuresErrorsBesideTheLightThatArrives) {
  const Scene open = floorUnderSlab(), shaft = floorInShaft(8);
  const RefineOptions measured{.bound = 1.0f};
  const double in_the_open = refined(open, measured).report.error_before,
               in_the_shaft = refined(shaft, measured).report.error_before;
  // The walls' inner faces and the floor are a quarter of the surface; their relative errors are larger.
  EXPECT_GT(in_the_shaft, 0.5 * in_the_open);
}

TEST(Refinement, FindsTheShadowOfACubeOnAWideGround) {
  const Scene scene = sceneOf({grid({0, 0, 0}, 200.0f, 1), box({0.0f, 0.5f, 0.0f}, glm::vec3(1.0f), 2)});
  const Refined result = refined(scene, {.bound = 0.02f});
  EXPECT_GT(result.report.error_before, 0.05);
  EXPECT_LT(result.report.error_after, 0.02);
  std::size_t near = 0;
  for (const glm::vec3& p : result.meshes[0][0].positions) near += glm::length(p) < 2.0f;
  EXPECT_GT(near, 12u) << "the ground has two triangles";
}

TEST(Refinement, FollowsTheLightOfAPanelInAClosedRoom) {
  Scene scene = sceneOf({flipped(box({0, 0, 0}, {4.0f, 3.0f, 4.0f}, 2)),
                         box({0, -0.6f, 0}, {1.2f, 0.1f, 1.2f}, 1), flipped(grid({0, 1.45f, 0}, 0.6f, 1))});
  scene.materials.resize(2);
  scene.materials[1].emissive = glm::vec3(5.0f);
  scene.meshes[2].primitives[0].material = 1;
  const Refined result = refined(scene, {.bound = 0.05f});
  EXPECT_GT(result.report.error_before, 0.1);
  EXPECT_GT(result.report.vertices_after, 2 * result.report.vertices_before) << "the shadow of the table";
}

// Returns the error of meshes as more rays than those of refinement measure it.
double errorByMoreRays(const Scene& scene, const Meshes& meshes) {
  Scene split = scene;
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t p = 0; p < meshes[m].size(); ++p) split.meshes[m].primitives[p].mesh = meshes[m][p];
  return refined(split, {.bound = 1.0f, .rays = 4096, .rounds = 0}).report.error_after;
}

TEST(Refinement, DoesNotTakeTheNoiseOfFewRaysForASmallError) {
  const Scene scene = floorInShaft(1);
  const RefineOptions few{.bound = 0.03f, .rays = 128, .many_rays = 128};
  RefineOptions many = few;
  many.many_rays = 2048;
  const Refined by_few = refined(scene, few), by_many = refined(scene, many);
  EXPECT_LT(by_few.report.error_after, 0.03);
  EXPECT_LT(by_many.report.error_after, 0.03);
  // Few rays split what their noise makes look worst and then call the rest right.
  EXPECT_GT(errorByMoreRays(scene, by_few.meshes), 0.05);
  EXPECT_LT(errorByMoreRays(scene, by_many.meshes), 0.04)
      << "that of the worst of many regions has more noise";
}

TEST(Refinement, BringsWhatAGlossyFloorReflectsUnderTheBound) {
  Scene scene = floorUnderSlab();
  scene.materials[0].metallic = 1.0f;
  const Refined result = refined(scene, {.bound = 0.02f}, /*with_glossy=*/true);
  EXPECT_GT(result.report.error_before, 0.05);
  EXPECT_LT(result.report.error_after, 0.02);
}

// Makes a closed box with thin walls on a floor of two halves, each of two triangles: it is dark inside.
const glm::vec3 kBoxCentre(0.07f, 0.25f, -0.31f);
Scene darkBox() {
  return sceneOf({grid({-1, 0, 0}, 2.0f, 1), grid({1, 0, 0}, 2.0f, 1), box(kBoxCentre, {1.0f, 0.6f, 1.0f}, 1),
                  flipped(box(kBoxCentre, {0.96f, 0.56f, 0.96f}, 1))});
}

TEST(Refinement, CutsFacesWhereWallsStandOnThem) {
  const Refined result = refined(darkBox(), {.bound = 0.02f});
  EXPECT_LT(result.report.error_after, 0.02);
  // Halves of edges, which miss the walls, spend all 20,000 vertices and leave 3 %.
  EXPECT_LT(result.report.vertices_after, 3000u);
  std::array<std::set<float>, 2> on_seam;
  for (std::size_t half = 0; half < 2; ++half)
    for (const glm::vec3& p : result.meshes[half][0].positions)
      if (p.x == 0.0f) on_seam[half].insert(p.z);
  EXPECT_GT(on_seam[0].size(), 4u);
  EXPECT_EQ(on_seam[0], on_seam[1]);
}

// Walls of 2 cm hide the inner points of the faces that cross them, so no error shows that these bring light
// in.
TEST(Refinement, LeavesNoFaceFromTheLightIntoADarkBox) {
  const Refined result = refined(darkBox(), {.bound = 0.02f});
  double crossing = 0.0;  // length inside of edges that lead outside, m
  for (std::size_t half = 0; half < 2; ++half) {
    const bundle::MeshData& floor = result.meshes[half][0];
    const auto fromCentre = [&](std::size_t corner) {
      const glm::vec3 p = glm::abs(floor.positions[floor.indices[corner]] - kBoxCentre);
      return std::max(p.x, p.z);
    };
    for (std::size_t i = 0; i < floor.indices.size(); ++i) {
      const float from = fromCentre(i), to = fromCentre(i % 3 == 2 ? i - 2 : i + 1);
      if (std::min(from, to) < 0.48f && std::max(from, to) > 0.5f)
        crossing += double{0.48f - std::min(from, to)};
    }
  }
  EXPECT_LT(crossing, 0.1);
}

TEST(Refinement, EndsWithTheVerticesThatItMayAdd) {
  const Refined result = refined(floorUnderSlab(), {.bound = 1e-4f, .most_growth = 1.0, .most_added = 500});
  EXPECT_GT(result.report.vertices_after, result.report.vertices_before + 250);
  EXPECT_LE(result.report.vertices_after, result.report.vertices_before + 600);
}

// Copies have samples of their own, and cost as much as meshes of their own.
TEST(Refinement, CountsAMeshAsOftenAsItIsDrawn) {
  constexpr std::size_t kCopies = 16;
  Scene scene = floorUnderSlab();
  for (std::size_t i = 1; i < kCopies; ++i) {
    for (std::size_t n = 0; n < 2; ++n) {
      scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
      scene.nodes.push_back(scene.nodes[n]);
      scene.nodes.back().parent_from_node =
          glm::translate(glm::mat4(1.0f), glm::vec3(5.0f * static_cast<float>(i), 0.0f, 0.0f));
    }
  }
  const Refined result = refined(scene, {.bound = 1e-4f, .most_growth = 1.0, .most_added = 1600});
  const std::size_t added = result.report.vertices_after - result.report.vertices_before;
  EXPECT_GT(kCopies * added, 800u);
  EXPECT_LE(kCopies * added, 2000u);
}

TEST(ShadowProbe, OfAClosedBoxMissesAllOfTheLight) {
  const testing::Transport t(sceneOf({testing::flipped(box({0, 0, 0}, {2, 2, 2}, 1))}));
  const ShadowProbe probe(1024);
  const SampleOrigin inside{{0.1f, 0.0f, 0.2f}, {0.0f, 1.0f, 0.0f}, 1.0f};
  std::vector<std::uint16_t> hidden(probe.packets()), open(probe.packets(), 0);
  const glm::vec3 up(0.0f, 1.0f, 0.0f);
  for (const SampleKind kind : {SampleKind::Diffuse, SampleKind::Glossy}) {
    probe.look(t.rays, std::span(&inside, 1), up, kind, hidden);
    const HiddenFrom corner{open, up, 1.0f / 3.0f};
    EXPECT_NEAR(
        ShadowProbe::squareError(probe.difference(std::array{corner, corner, corner}, {hidden, up}, kind)),
        1.0, 0.01)
        << "relative to an open point";
  }
}

}  // namespace
}  // namespace lambent::baker
