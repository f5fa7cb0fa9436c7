// Tests neighborhoods from the scene to the file and back: they match closed forms, and are always finite.
#include "tests/support/neighborhood.hpp"

#include "baker/bake/bake.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/support/program.hpp"

namespace lambent {
namespace {

using testing::grid;
using testing::icosphere;
using testing::sceneOf;

// Holds a grid as stored in a file.
struct Stored {
  bundle::NeighborhoodGrid grid;
  baker::ChangeShape shape;
  std::vector<float> visibility, bounced;

  baker::GridPlacement placement() const { return {grid.size, {grid.bounds_min, grid.bounds_max}}; }
};

class NeighborhoodBundle : public testing::ProgramTest {
 protected:
  // Makes a floor of 8 m, and a body with a node of its own.
  static baker::Scene over(const bundle::MeshData& body, const glm::vec3& place) {
    baker::Scene scene = sceneOf({grid({0, 0, 0}, 8.0f, 8), body});
    scene.nodes[1].name = "body";
    scene.nodes[1].movable = true;
    scene.nodes[1].parent_from_node = glm::translate(glm::mat4(1.0f), place);
    scene.neighborhoods = {{.node = 1}};
    return scene;
  }

  std::optional<Stored> bake(const baker::Scene& scene, int bounces = 0) const {
    baker::BakeOptions options;
    options.quality = baker::Quality::Draft;
    options.bounces = bounces;
    options.neighborhood_grid = {12, 12, 6};
    const std::filesystem::path path = folder / "scene.lmb.glb";
    baker::Progress progress;
    const auto report = baker::bake(scene, options, path, {progress});
    EXPECT_TRUE(report) << report.error().line();
    if (!report) return std::nullopt;
    const auto reader = bundle::Reader::open(path);
    EXPECT_TRUE(reader) << reader.error().line();
    if (!reader) return std::nullopt;
    const auto checked = reader->checkAll();
    EXPECT_TRUE(checked) << checked.error().line();
    const bundle::Description& d = reader->description();
    for (std::uint32_t g = 0; g < d.groups.size(); ++g) {
      if (!d.groups[g].neighborhood) continue;
      EXPECT_EQ(report->neighborhoods.size(), 1u);
      Stored stored{.grid = *d.groups[g].neighborhood, .shape = {}, .visibility = {}, .bounced = {}};
      for (std::uint32_t c = 0; c < d.groups[g].cells.size(); ++c) {
        const bundle::Cell& cell = d.groups[g].cells[c];
        if (cell.domain != transfer::Domain::GridPoint) continue;
        for (std::uint32_t t = 0; t < cell.transfers.size(); ++t) {
          const transfer::TransferShape& shape = cell.transfers[t].shape;
          const bundle::GroupIndex group{g};
          const bundle::CellIndex of{c};
          const bundle::TransferIndex part{t};
          const auto codes = reader->readCodebook(group, of, part);
          EXPECT_TRUE(codes);
          std::vector<std::vector<std::uint32_t>> planes;
          for (std::uint32_t j = 0; j < cell.transfers[t].planes.size(); ++j)
            planes.push_back(*reader->readPlane(group, of, part, bundle::PlaneIndex{j}));
          const auto values = transfer::decodeTransfer(shape, codes->codebook, codes->cluster_of, planes);
          (shape.isVisibility() ? stored.visibility : stored.bounced) = values;
          stored.shape.order = static_cast<int>(shape.order);
          stored.shape.order_out = static_cast<int>(transfer::bandsOf(shape.outputs));
          if (!shape.isVisibility()) stored.shape.channels = shape.full_channels;
        }
      }
      for (const float value : stored.visibility) EXPECT_TRUE(std::isfinite(value));
      for (const float value : stored.bounced) EXPECT_TRUE(std::isfinite(value));
      return stored;
    }
    EXPECT_TRUE(report->neighborhoods.empty());
    return std::nullopt;
  }
};

TEST_F(NeighborhoodBundle, OfABlackBallHoldsItsClosedForm) {
  // The ball may also be far from its node, because the grid is in the group's frame.
  for (const glm::vec3 off : {glm::vec3(0.0f), glm::vec3(300.0f, 40.0f, 0.0f)}) {
    auto scene = over(icosphere(off, 0.5f, 4), glm::vec3(0.0f, 0.8f, 0.0f) - off);
    testing::ownMaterial(scene, 1).base_color = {0, 0, 0, 1};
    const auto stored = bake(scene);
    ASSERT_TRUE(stored.has_value());
    EXPECT_TRUE(stored->bounced.empty());
    EXPECT_EQ(std::size_t{stored->grid.size.x} * stored->grid.size.y * stored->grid.size.z, 12u * 12u * 6u);
    // The expected values are fitted between the points, as a bake does.
    const baker::GridPlacement placement = stored->placement();
    constexpr std::size_t kMatrix = 9 * 25;
    std::vector<float> truth;
    std::vector<std::uint8_t> outside;
    for (std::size_t p = 0; p < placement.count(); ++p) {
      const glm::vec3 point = placement.point(p) - off;
      outside.push_back(glm::length(point) < 0.5f ? 0 : 1);
      const auto change = testing::blackSphereChange(point, 0.5f, 5, 3);
      truth.insert(truth.end(), change.begin(), change.end());
    }
    baker::fitBetweenPoints(placement, outside, kMatrix, truth);
    int looked_at = 0;
    for (std::size_t p = 0; p < placement.count(); ++p) {
      if (glm::length(placement.point(p) - off) < 0.52f) continue;
      ++looked_at;
      const std::size_t size = stored->shape.visibilitySize();
      auto wrong =
          testing::matrixOf(stored->shape, std::span(stored->visibility).subspan(p * size, size), {});
      for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] -= truth[p * kMatrix + i];
      // A draft uses 512 rays, and codes are exact to a third of a percent.
      EXPECT_LT(testing::irradianceOf(wrong, 5, 3), 0.02) << p;
    }
    EXPECT_GT(looked_at, 600);
  }
}

TEST_F(NeighborhoodBundle, OfAWhiteBallSendsBackWhatItTakesOfUniformLight) {
  const auto stored = bake(over(icosphere({0, 0, 0}, 0.5f, 3), {0, 0.8f, 0}), /*bounces=*/2);
  ASSERT_TRUE(stored.has_value());
  ASSERT_FALSE(stored->bounced.empty());
  for (std::size_t p = 0; p < 12u * 12u * 6u; ++p) {
    const std::size_t v = stored->shape.visibilitySize(), b = stored->shape.bouncedSize();
    const auto change = testing::matrixOf(stored->shape, std::span(stored->visibility).subspan(p * v, v),
                                          std::span(stored->bounced).subspan(p * b, b));
    EXPECT_NEAR(change[0], 0.0f, 0.02f) << p;
  }
}

TEST_F(NeighborhoodBundle, OfHostileBodiesIsFiniteOrNone) {
  bundle::MeshData triangle;
  triangle.positions = {{0, 0, 0}, {0.5f, 0, 0}, {0, 0, -0.5f}};
  triangle.normals.assign(3, {0, 1, 0});
  triangle.indices = {0, 1, 2};
  EXPECT_TRUE(bake(over(triangle, {0, 0.5f, 0})).has_value());

  EXPECT_TRUE(bake(over(testing::soup(3, 0.3f, 0.5f), {0, 0.5f, 0})).has_value());
  // The bodies are half in the floor, tiny, and huge.
  EXPECT_TRUE(bake(over(icosphere({0, 0, 0}, 0.5f, 2), {0, 0, 0})).has_value());
  EXPECT_TRUE(bake(over(icosphere({0, 0, 0}, 1e-4f, 2), {0, 1e-4f, 0})).has_value());
  EXPECT_TRUE(bake(over(icosphere({0, 0, 0}, 50.0f, 2), {0, 51, 0})).has_value());
  // The body is out of everyone's reach.
  EXPECT_FALSE(bake(over(icosphere({0, 0, 0}, 0.1f, 2), {0, 500, 0})).has_value());
}

}  // namespace
}  // namespace lambent
