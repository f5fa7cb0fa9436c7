// Tests volumes in the whole bake: what is quantized, what is refused, what is left out.
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "baker/bake/bake.hpp"
#include "baker/bake/bake_group.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/support/decoded_bundle.hpp"
#include "tests/support/program.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {

namespace {

class VolumeBake : public testing::ProgramTest {
 protected:
  BakeReport bakeTo(const std::string& name, const Scene& scene, const BakeOptions& options) const {
    Progress progress;
    const auto report = bake(scene, options, folder / name, {progress});
    EXPECT_TRUE(report) << report.error().line();
    return report ? *report : BakeReport();
  }
};

Scene foggy() {
  Scene scene = testing::sceneOf({testing::grid({0, -1, 0}, 4.0f, 4)});
  SceneVolume volume;
  volume.name = "fog";
  volume.node = 0;
  volume.size = {3, 2, 2};
  volume.density = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 255};
  scene.volumes.push_back(volume);
  return scene;
}

BakeOptions small() {
  BakeOptions options;
  options.quality = Quality::Draft;
  options.order = 2;
  options.volume_grid = glm::uvec3(4);
  return options;
}

TEST(QuantizedDensity, IsExactInEightBitsWhereTheSourceHadThem) {
  const QuantizedDensity density = quantizeDensity(std::vector<float>{0, 51, 102, 255});
  EXPECT_EQ(density.bits, 8u);
  EXPECT_EQ(density.largest, 255.0f);
  EXPECT_EQ(density.values, (std::vector<float>{0, 51, 102, 255}));
  EXPECT_EQ(density.codes,
            (std::vector<std::byte>{std::byte{0}, std::byte{51}, std::byte{102}, std::byte{255}}));
  EXPECT_EQ(density.error, 0.0);
}

TEST(QuantizedDensity, TakesSixteenBitsWhereOnePeakWouldDrownTheRest) {
  std::vector<float> values(1000, 0.7f);
  values[10] = 20.0f;
  const QuantizedDensity density = quantizeDensity(values);
  EXPECT_EQ(density.bits, 16u);
  EXPECT_EQ(density.codes.size(), 2000u);
  EXPECT_LT(density.error, 5e-4);
  EXPECT_NEAR(density.values[0], 0.7f, 20.0f / 65535.0f);
}

TEST_F(VolumeBake, WritesTheSameBytesWithOneThreadAndWithTwo) {
  const auto bytesWith = [&](unsigned threads) {
    BakeOptions options = small();
    options.threads = threads;
    bakeTo("fog.lmb.glb", foggy(), options);
    std::ifstream file(folder / "fog.lmb.glb", std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string one = bytesWith(1);
  EXPECT_FALSE(one.empty());
  EXPECT_TRUE(one == bytesWith(2));
}

// As in the reference, the number of bounces counts those between surfaces.
TEST_F(VolumeBake, ScattersAsOftenAsItDoesHoweverFewBouncesAreAskedFor) {
  const auto iterationsWith = [&](int bounces) {
    BakeOptions options = small();
    options.bounces = bounces;
    return bakeTo("fog.lmb.glb", foggy(), options).volumes.at(0).iterations;
  };
  const int all = iterationsWith(-1);
  EXPECT_GT(all, 1);
  EXPECT_EQ(iterationsWith(1), all);
  EXPECT_EQ(iterationsWith(0), 0);
}

TEST_F(VolumeBake, KeepsNineOutputsOfBroadPhasesAndMatricesOfNarrowOnes) {
  for (const auto& [g, outputs, transfers] : {std::tuple{0.0f, 1u, 1u}, {-0.4f, 9u, 1u}, {0.7f, 16u, 2u}}) {
    Scene scene = foggy();
    scene.volumes[0].g = g;
    BakeOptions options = small();
    options.order = 4;
    bakeTo("phase.lmb.glb", scene, options);
    const auto reader = bundle::Reader::open(folder / "phase.lmb.glb");
    ASSERT_TRUE(reader) << reader.error().line();
    bool found = false;
    for (const bundle::Group& group : reader->description().groups) {
      if (!group.volume) continue;
      found = true;
      EXPECT_EQ(group.volume->g, g);
      for (const bundle::Cell& cell : group.cells) {
        if (cell.domain != transfer::Domain::Voxel) continue;
        ASSERT_EQ(cell.transfers.size(), transfers);
        EXPECT_EQ(cell.outputs(), outputs);
        EXPECT_EQ(cell.transfers[0].shape.visibility_bands, transfers == 2 ? 7u : 0u);
      }
    }
    EXPECT_TRUE(found);
  }
}

TEST(VolumePlan, RefusesNarrowPhasesWithMoreBandsOrVoxelsThanMatricesMayHave) {
  Scene scene = foggy();
  scene.volumes[0].g = 0.8f;
  const auto refusal = [&](int order, std::uint32_t voxels) {
    BakeOptions options = small();
    options.order = order;
    options.volume_grid = glm::uvec3(voxels);
    options.effects = "diffuse,volume";
    const auto plan = planFor(scene, options);
    EXPECT_FALSE(plan);
    return plan ? std::string() : plan.error().line();
  };
  EXPECT_NE(refusal(7, 4).find("give --order 6"), std::string::npos);
  EXPECT_NE(refusal(5, 128).find("--volume-grid of at most"), std::string::npos);
}

// Tests that what a plan leaves out is not missed: with everything forced on the bundle shows the same.

using testing::DecodedDraw;

struct Baked {
  BakeReport report;
  std::vector<DecodedDraw> draws;
};

class LeftOut : public ::testing::Test {
 protected:
  Baked bakeWith(const Scene& scene, const std::string& effects) const {
    Progress progress;
    const auto output = folder_.path() / (effects + ".lmb.glb");
    const BakeOptions options{.quality = Quality::Draft, .error_bound = 1e-4f, .effects = effects};
    auto report = bake(scene, options, output, {progress});
    EXPECT_TRUE(report) << report.error().line();
    auto draws = testing::decodeBundle(output);
    EXPECT_TRUE(draws) << draws.error().line();
    return {std::move(*report), std::move(*draws)};
  }

 private:
  testing::TemporaryFolder folder_;
};

// Relative RMS of transfer at vertices; refinement must not have added any.
double difference(const Baked& a, const Baked& b) {
  double square = 0.0, all = 0.0;
  EXPECT_EQ(a.draws.size(), b.draws.size());
  for (std::size_t d = 0; d < a.draws.size(); ++d) {
    EXPECT_EQ(a.draws[d].transfer.size(), b.draws[d].transfer.size());
    for (std::size_t i = 0; i < a.draws[d].transfer.size(); ++i) {
      square += std::pow(double{a.draws[d].transfer[i]} - double{b.draws[d].transfer[i]}, 2);
      all += std::pow(double{b.draws[d].transfer[i]}, 2);
    }
  }
  return std::sqrt(square / all);
}

TEST_F(LeftOut, ShadowsOfABallAreNotMissed) {
  const Scene scene = testing::sceneOf({testing::icosphere({0, 0, 0}, 1.0f, 3)});
  const Baked planned = bakeWith(scene, "auto"), all = bakeWith(scene, "all");
  EXPECT_EQ(planned.report.rays + planned.report.refinement.rays, 0u);
  EXPECT_GT(all.report.rays, 0u);
  EXPECT_GT(all.report.refinement.rays, 0u);
  EXPECT_LT(difference(planned, all), 5e-4) << "codes alone may differ by 2e-4";
}

TEST_F(LeftOut, BouncesOfBlackSurfacesAreNotMissed) {
  Scene scene = testing::sceneOf(
      {testing::grid({0, 0, 0}, 3.0f, 8), testing::box({0.1f, 0.6f, 0.2f}, {0.8f, 0.6f, 0.7f}, 3)});
  scene.materials[0].base_color = glm::vec4(1e-4f, 1e-4f, 1e-4f, 1.0f);
  scene.materials[0].specular = 0.0f;
  const Baked planned = bakeWith(scene, "auto"), all = bakeWith(scene, "all");
  EXPECT_EQ(planned.report.hit_bytes, 0u) << "hits are kept for bounces alone";
  EXPECT_GT(all.report.hit_bytes, 0u);
  EXPECT_LT(difference(planned, all), 5e-4);
}

}  // namespace

}  // namespace lambent::baker
