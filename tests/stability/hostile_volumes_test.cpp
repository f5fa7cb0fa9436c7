// Tests, from the scene to the bytes and back, volumes that could break a baker.
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/stability/end_to_end_bake.hpp"

namespace lambent {
namespace {

class HostileVolume : public testing::ProgramTest {
 protected:
  // Adds a centred cube of fog, of edge 1 and with this many voxels, at a node of its own.
  static void addFog(baker::Scene& scene, std::uint32_t voxels, float sigma,
                     const glm::mat4& place = glm::mat4(1.0f)) {
    baker::SceneVolume volume;
    volume.name = "fog";
    volume.node = static_cast<std::uint32_t>(scene.nodes.size());
    volume.size = glm::uvec3(voxels);
    volume.density.assign(std::size_t{voxels} * voxels * voxels, sigma);
    volume.node_from_grid = glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(-0.5f)),
                                       glm::vec3(1.0f / static_cast<float>(voxels)));
    volume.albedo = glm::vec3(0.9f, 0.8f, 0.7f);
    gltf::Node node;
    node.parent_from_node = place;
    scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
    scene.nodes.push_back(node);
    scene.volumes.push_back(std::move(volume));
  }

  struct Baked {
    bundle::Group group;  // of the first volume
    std::vector<float> vectors;
    std::size_t size = 1;
    std::uint32_t full_channels = 0;
  };

  Baked bakeFog(const baker::Scene& scene) const {
    baker::BakeOptions options;
    options.quality = baker::Quality::Draft;
    options.order = 3;
    options.error_bound = 1e-3f;
    options.volume_grid = {6, 7, 5};
    options.effects = "diffuse,volume";  // not what it does to the surfaces around it
    const std::filesystem::path path = folder / "fog.lmb.glb";
    baker::Progress progress;
    const auto report = baker::bake(scene, options, path, {progress});
    EXPECT_TRUE(report) << report.error().line();
    const auto reader = bundle::Reader::open(path);
    EXPECT_TRUE(reader) << reader.error().line();
    if (!report || !reader) return {};
    const auto checked = reader->checkAll();
    EXPECT_TRUE(checked) << checked.error().line();
    const bundle::Description& d = reader->description();
    for (const auto& view : d.views) EXPECT_GT(view.length, 0u) << "glTF has no empty bufferViews";
    for (std::uint32_t g = 0; g < d.groups.size(); ++g)
      if (d.groups[g].volume) return decode(*reader, g);
    ADD_FAILURE() << "no volume in the bundle";
    return {};
  }

  // Uniform light of radiance 1 gives values in 0..1.
  static void expectInRange(const Baked& baked) {
    const double root = std::sqrt(4.0 * std::numbers::pi);
    for (std::size_t i = 0; i < baked.vectors.size(); ++i) {
      ASSERT_TRUE(std::isfinite(baked.vectors[i]));
      if (i % 9 != 0) continue;
      ASSERT_GE(double{baked.vectors[i]} * root, -0.01);
      ASSERT_LE(double{baked.vectors[i]} * root, 1.01);
    }
  }

 private:
  static Baked decode(const bundle::Reader& reader, std::uint32_t g) {
    Baked baked{.group = reader.description().groups[g], .vectors = {}};
    for (std::uint32_t c = 0; c < baked.group.cells.size(); ++c) {
      const bundle::GroupIndex group{g};
      const bundle::CellIndex cell{c};
      const bundle::CellTransfer& transfer = baked.group.cells[c].transfers.at(0);
      EXPECT_EQ(baked.group.cells[c].domain, transfer::Domain::Voxel);
      baked.size = transfer.shape.size();
      baked.full_channels = transfer.shape.full_channels;
      std::vector<std::vector<std::uint32_t>> planes;
      for (std::uint32_t j = 0; j < transfer.planes.size(); ++j)
        planes.push_back(*reader.readPlane(group, cell, {}, bundle::PlaneIndex{j}));
      const auto codes = reader.readCodebook(group, cell, {});
      EXPECT_TRUE(codes) << codes.error().line();
      const auto vectors =
          transfer::decodeTransfer(transfer.shape, codes->codebook, codes->cluster_of, planes);
      baked.vectors.insert(baked.vectors.end(), vectors.begin(), vectors.end());
    }
    return baked;
  }
};

baker::Scene ground() {
  return testing::sceneOf({testing::grid({0, -1, 0}, 4.0f, 4)});
}

TEST_F(HostileVolume, OfAnyOpticalDepthStaysInRange) {
  for (const float sigma : {1e-6f, 1.0f, 1e6f}) {
    baker::Scene scene = ground();
    addFog(scene, 3, sigma);
    const Baked baked = bakeFog(scene);
    EXPECT_EQ(baked.full_channels, 3u);
    EXPECT_EQ(baked.group.sample_count, 6u * 7u * 5u);
    EXPECT_EQ(baked.group.within, 0);
    expectInRange(baked);
  }
}

TEST_F(HostileVolume, ThatIsEmptyShipsNoSample) {
  baker::Scene scene = ground();
  addFog(scene, 4, 0.0f);
  const Baked baked = bakeFog(scene);
  EXPECT_EQ(baked.group.sample_count, 0u);
  EXPECT_TRUE(baked.group.cells.empty());
  EXPECT_EQ(baked.group.volume->density_max, 0.0f);
}

TEST_F(HostileVolume, OfOneVoxelAndAloneInItsSceneIsBaked) {
  baker::Scene scene;
  scene.source = "alone.gltf";
  addFog(scene, 1, 2.0f);
  const Baked baked = bakeFog(scene);
  EXPECT_EQ(baked.group.within, -1);
  EXPECT_EQ(baked.group.volume->size, glm::uvec3(1));
  expectInRange(baked);
}

TEST_F(HostileVolume, InsideAClosedMeshIsDark) {
  baker::Scene scene = testing::sceneOf({testing::icosphere({0, 0, 0}, 2.0f, 2)});
  addFog(scene, 2, 3.0f);
  for (const float value : bakeFog(scene).vectors) ASSERT_NEAR(value, 0.0f, 1e-4f);
}

// Density is per metre in world space: a volume of twice the size and half the density looks the same, for
// any placement, rotation and mirroring.
TEST_F(HostileVolume, OfAnySizePlaceAndTurnHasTheTransferOfItsOpticalDepth) {
  const auto meanOf = [&](const glm::mat4& place, float sigma) {
    baker::Scene scene;
    scene.source = "turned.gltf";
    addFog(scene, 2, sigma, place);
    const Baked baked = bakeFog(scene);
    expectInRange(baked);
    double sum = 0.0;
    for (std::size_t i = 0; i < baked.vectors.size(); i += baked.size) sum += double{baked.vectors[i]};
    return sum / static_cast<double>(baked.vectors.size() / baked.size);
  };
  const double wanted = meanOf(glm::mat4(1.0f), 3.0f);
  const glm::mat4 far = glm::translate(glm::mat4(1.0f), {3000, -200, 50});
  EXPECT_NEAR(meanOf(glm::scale(glm::rotate(far, 1.0f, {0, 1, 0}), glm::vec3(2.0f)), 1.5f), wanted,
              2e-3 * wanted);
  EXPECT_NEAR(meanOf(glm::scale(glm::mat4(1.0f), {-1e-3f, 1e-3f, 1e-3f}), 3000.0f), wanted, 2e-3 * wanted);
}

}  // namespace
}  // namespace lambent
