// Compares kernels with their CPU twin on random codes and lights, and tests what makes them run.
#include "runtime/effects/diffuse/diffuse.hpp"
#include "tests/runtime/evaluate/glossy_bench.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::evaluate {

using GlossyGpu = lambent::testing::GpuTest;
using testing::Bench;

TEST_F(GlossyGpu, MatchesItsTwinAtEveryOrderOfLightAndSurface) {
  lambent::testing::BundleMaker maker(31);
  for (const std::uint32_t order : {3u, 5u, 6u})
    for (const std::uint32_t bands : {4u, 5u, 6u}) {
      Bench bench(maker,
                  {.order = order, .cells = 1, .glossy_cells = 2, .glossy_bands = bands, .samples = 67});
      bench.uploadAll();
      bench.shade();
      EXPECT_LT(bench.differenceToTwin(), 1e-4) << order << " bands in, " << bands << " out";
    }
}

TEST_F(GlossyGpu, MatchesItsTwinWithClustersBouncesLampsAndSeveralLightProbes) {
  lambent::testing::BundleMaker maker(32);
  for (const std::uint32_t clusters : {1u, 40u})
    for (const std::uint32_t lamps : {0u, 3u})
      for (const std::uint32_t lights : {1u, 7u}) {
        Bench bench(maker, {.order = 5,
                            .full_channels = 3,
                            .clusters = clusters,
                            .lamps = lamps,
                            .cells = 1,
                            .mapped_cells = 1,
                            .glossy_cells = 2,
                            .bounced = true,
                            .samples = 123,
                            .light_probes = lights});
        bench.uploadAll();
        for (const TransferMode mode :
             {TransferMode::Full, TransferMode::Shadowed, TransferMode::Unshadowed}) {
          bench.shade(mode);
          EXPECT_LT(bench.differenceToTwin(), 1e-4)
              << clusters << " clusters, " << lamps << " lamps, " << lights << " lights";
        }
        for (lighting::GroupPlace& place : bench.places) place.lamps_apart.assign(lamps, 1.0f);
        bench.shade(TransferMode::Full);
        EXPECT_LT(bench.differenceToTwin(), 1e-4) << "lamps stand apart, " << lamps << " lamps";
      }
}

TEST_F(GlossyGpu, ShadesPointsOfNeighborhoodsAlsoWhereNothingIsGlossy) {
  lambent::testing::BundleMaker maker(39);
  for (const std::uint32_t bands : {3u, 4u, 5u})
    for (const bool bounced : {false, true}) {
      Bench bench(maker, {.order = 5,
                          .clusters = 9,
                          .cells = 1,
                          .neighborhood_cells = 2,
                          .neighborhood_bands = bands,
                          .bounced = bounced,
                          .samples = 105});
      bench.uploadAll();
      bench.shade();
      EXPECT_EQ(bench.samples.cellsShadedLast(), 4u);
      EXPECT_LT(bench.differenceToTwin(), 1e-4) << bands << " bands";
      bench.shade(TransferMode::Shadowed);
      EXPECT_LT(bench.differenceToTwin(), 1e-4) << bands << " bands";
    }
}

TEST_F(GlossyGpu, PointsWithoutTransferChangeNothing) {
  lambent::testing::BundleMaker maker(40);
  Bench bench(maker, {.groups = 1, .cells = 0, .glossy_cells = 1, .neighborhood_cells = 1});
  const auto points = [&] {
    const streaming::ResidentCell& cell = bench.residency.cells()[1];
    const auto page = Bench::samplesOf(bench.residency.samples(), bench.residency.groups()[0].samples.page);
    return std::vector<glm::vec4>(page.begin() + cell.first_output,
                                  page.begin() + cell.first_output + 9 * cell.sample_count);
  };
  const auto none = [](const std::vector<glm::vec4>& values) {
    return std::ranges::all_of(values, [](const glm::vec4& value) { return value == glm::vec4(0.0f); });
  };
  for (const auto& item : bench.made.meshes) bench.upload(item);
  for (const auto& item : bench.made.rows) bench.upload(item);
  bench.shade();
  EXPECT_TRUE(none(points())) << "nothing has arrived";
  bench.uploadTransfer();
  bench.shade();
  EXPECT_FALSE(none(points()));
  bench.shade(TransferMode::Unshadowed);
  EXPECT_TRUE(none(points()));
}

TEST_F(GlossyGpu, ShadowedLeavesBouncedLightOut) {
  lambent::testing::BundleMaker maker(33);
  Bench bench(maker, {.groups = 1, .cells = 0, .glossy_cells = 1, .bounced = true});
  bench.uploadAll();
  EXPECT_EQ(bench.shade(), 4u) << "visibility, dense, samples, adding";
  EXPECT_EQ(bench.shade(TransferMode::Shadowed), 2u);
  EXPECT_EQ(bench.shade(TransferMode::Unshadowed), 1u) << "fill";
}

TEST_F(GlossyGpu, ShowsTheLightItselfUntilTransferIsThere) {
  lambent::testing::BundleMaker maker(34);
  Bench bench(maker, {.groups = 1, .cells = 0, .glossy_cells = 2});
  for (const auto& item : bench.made.meshes) bench.upload(item);
  for (const auto& item : bench.made.rows) bench.upload(item);
  EXPECT_EQ(bench.shade(), 1u) << "fill";
  EXPECT_LT(bench.differenceToTwin(), 1e-6);
  EXPECT_EQ(bench.shade(), 0u);
  bench.uploadCell(1);
  EXPECT_EQ(bench.shade(), 2u) << "project and samples of the cell that arrived";
  EXPECT_EQ(bench.samples.cellsShadedLast(), 1u);
  EXPECT_LT(bench.differenceToTwin(), 1e-4);
}

TEST_F(GlossyGpu, RunsOnlyWhenLightOrTransferChanged) {
  lambent::testing::BundleMaker maker(35);
  Bench bench(maker, {.groups = 2, .cells = 1, .glossy_cells = 1});
  bench.uploadAll();
  EXPECT_GT(bench.shade(), 0u);
  EXPECT_EQ(bench.shade(), 0u) << "a still frame";
  const std::uint64_t version = bench.samples.matricesVersionOf(0);
  bench.environment.setTurn(10.0f);
  EXPECT_EQ(bench.shade(), 2u);
  EXPECT_EQ(bench.samples.matricesVersionOf(0), version + 1);
  bench.places[1].world_from_group = maker.rotation();
  bench.shade();
  EXPECT_EQ(bench.samples.cellsShadedLast(), 1u) << "of the group that turned";
}

TEST_F(GlossyGpu, DispatchesNothingWithoutGlossyCells) {
  lambent::testing::BundleMaker maker(36);
  Bench bench(maker, {.cells = 2, .mapped_cells = 1});
  bench.uploadAll();
  EXPECT_EQ(bench.shade(), 0u);
}

TEST_F(GlossyGpu, GlossyDrawsHaveNoRadianceAtTheirVertices) {
  lambent::testing::BundleMaker maker(37);
  Bench bench(maker, {.groups = 1, .cells = 0, .glossy_cells = 1});
  bench.uploadAll();
  EXPECT_EQ(bench.residency.radiance().pageCount(), 0u);
  effects::diffuse::Diffuse diffuse;
  gpu::Counters counters;
  bench.shade();
  ASSERT_TRUE(diffuse.shade(bench.residency, bench.lights, TransferMode::Full, bench.samples, counters));
  EXPECT_EQ(counters.dispatches, 0u);
}

TEST_F(GlossyGpu, ProxiesTakeTheFirstNineOutputsOfGlossySamples) {
  lambent::testing::BundleMaker maker(38);
  Bench bench(maker, {.order = 5, .groups = 1, .cells = 0, .glossy_cells = 1, .proxy_triangles = 30});
  bench.uploadAll();
  for (const auto& item : bench.made.proxies) bench.upload(item);
  bench.shade();
  effects::diffuse::Proxies proxies;
  gpu::Counters counters;
  const std::vector<std::uint64_t> shaded = {bench.samples.matricesVersionOf(0)};
  ASSERT_TRUE(proxies.shade(bench.residency, bench.lights, shaded, counters));
  std::vector<glm::vec4> radiance(proxies.triangles().size());
  proxies.radiance().read(0, std::span(radiance));
  const std::vector<glm::vec4> samples = Bench::samplesOf(bench.residency.samples(), 0);
  for (std::size_t t = 0; t < radiance.size(); ++t) {
    const effects::diffuse::ProxyTriangleRecord& triangle = proxies.triangles()[t];
    std::vector<float> transfer(9);
    sh::unoccludedTransfer(3, glm::vec3(triangle.normal[0], triangle.normal[1], triangle.normal[2]),
                           transfer);
    glm::vec3 expected(0.0f);
    for (uint e = triangle.first_entry; e < triangle.first_entry + triangle.entry_count; ++e) {
      const effects::diffuse::ProxyEntryRecord& entry = proxies.entries()[e];
      ASSERT_EQ(entry.outputs, 25u);
      for (uint j = 0; j < 9; ++j)
        expected += glm::vec3(entry.reflectance[0], entry.reflectance[1], entry.reflectance[2]) *
                    transfer[j] * glm::vec3(samples[entry.sample_index + j]);
    }
    expected = glm::max(expected, glm::vec3(0.0f));
    EXPECT_LT(glm::distance(glm::vec3(radiance[t]), expected), 1e-4f * (1.0f + glm::length(expected)));
  }
}

}  // namespace lambent::evaluate
