// Compares kernels with what they compute as C++, on random codes and lights, and tests what makes them run.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/runtime/effects/diffuse/diffuse_bench.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::effects::diffuse {

using DiffuseGpu = testing::GpuTest;

TEST_F(DiffuseGpu, MatchesItsTwinAtEveryOrderAndPrefix) {
  testing::BundleMaker maker(11);
  for (std::uint32_t order = 1; order <= 8; ++order)
    for (const std::uint32_t prefix : {1u, 4u, 7u}) {
      DiffuseBench bench(
          maker, {.order = order, .shadowed_channels = order % 2 == 0 ? 3u : 1u, .samples = 97 + order});
      bench.uploadMeshes();
      bench.uploadRows();
      bench.uploadTransfer(prefix);
      bench.shade();
      EXPECT_LT(bench.differenceToTwin(), 1e-3) << "order " << order << ", planes " << prefix;
    }
}

TEST_F(DiffuseGpu, ShadesTexelsAsItsTwinAndAveragesThemInMipLevels) {
  testing::BundleMaker maker(31);
  DiffuseBench bench(maker, {.mapped_cells = 1, .samples = 97, .texels = 32});
  bench.uploadMeshes();
  bench.shade();
  for (const glm::vec4& texel : bench.textureOf(0, 0))
    EXPECT_EQ(texel, glm::vec4(0.0f)) << "vertices show until rows are there";
  bench.uploadRows();
  bench.uploadTransfer(4);
  bench.shade();
  EXPECT_LT(bench.differenceToTwin(), 1e-3) << "vertices are shaded as without texels";
  const auto samples = DiffuseBench::pagesOf<glm::vec4>(bench.residency.samples());
  const auto rows = DiffuseBench::pagesOf(bench.residency.rows());
  std::size_t textures = 0;
  for (std::size_t d = 0; d < bench.diffuse.draws().size(); ++d) {
    const DrawRecord& draw = bench.diffuse.draws()[d];
    const streaming::ResidentDraw& resident = bench.residency.draws()[d];
    EXPECT_EQ(draw.texels, draw.outputs == 1 ? 32u : 0u);
    if (draw.texels == 0) continue;
    ++textures;
    glsl::ShadeTexels kernel;
    kernel.samples = samples[bench.residency.groups()[resident.group].samples.page];
    kernel.row_words = rows[resident.texel_rows.page];
    const std::vector<glm::vec4> texels = bench.textureOf(d, 0);
    glm::vec4 mean(0.0f), widest(0.0f);
    for (uint texel = 0; texel < texels.size(); ++texel) {
      const glm::vec4 wanted = kernel.texelRadiance(draw, texel);
      EXPECT_EQ(wanted.w, 1.0f);
      EXPECT_LT(glm::length(texels[texel] - wanted), 1e-3f * glm::length(wanted)) << "half floats";
      mean += texels[texel] / static_cast<float>(texels.size());
      widest = glm::max(widest, glm::abs(texels[texel]));
    }
    EXPECT_LT(glm::length(bench.textureOf(d, 5).front() - mean), 5e-3f * glm::length(widest));
  }
  EXPECT_EQ(textures, 2u);
  bench.shade(evaluate::TransferMode::Unshadowed);
  for (const glm::vec4& texel : bench.textureOf(0, 0)) EXPECT_EQ(texel, glm::vec4(0.0f));
}

TEST_F(DiffuseGpu, MatchesItsTwinWithClustersLampsBothBlocksAndNormalMaps) {
  testing::BundleMaker maker(12);
  for (const std::uint32_t clusters : {1u, 3u, 300u})
    for (const std::uint32_t lamps : {0u, 1u, 70u})
      for (const std::uint32_t mapped : {0u, 2u}) {
        DiffuseBench bench(maker, {.order = 4,
                                   .shadowed_channels = 1,
                                   .full_channels = 3,
                                   .clusters = clusters,
                                   .lamps = lamps,
                                   .cells = 2,
                                   .mapped_cells = mapped,
                                   .samples = 423});
        bench.uploadAll(4);
        for (const evaluate::TransferMode mode :
             {evaluate::TransferMode::Full, evaluate::TransferMode::Shadowed}) {
          bench.shade(mode);
          EXPECT_LT(bench.differenceToTwin(), 1e-3)
              << clusters << " clusters, " << lamps << " lamps, " << mapped << " mapped cells";
        }
      }
}

TEST_F(DiffuseGpu, MatchesItsTwinWhereSomeLampsStandApart) {
  testing::BundleMaker maker(27);
  for (const std::uint32_t full : {0u, 1u, 3u})
    for (const bool keys : {false, true}) {
      DiffuseBench bench(maker, {.order = 4,
                                 .full_channels = full,
                                 .clusters = 3,
                                 .lamps = 3,
                                 .cells = 1,
                                 .mapped_cells = 1,
                                 .samples = 222});
      if (keys) bench.shineByKeyLights();
      for (lighting::GroupPlace& place : bench.places) place.lamps_apart = {1.0f, 0.0f, 0.25f};
      bench.uploadAll(4);
      bench.shade();
      EXPECT_LT(bench.differenceToTwin(), 1e-3) << full << " channels";
      for (const transfer::TransferRecord& record : bench.samples.tables().transfers) {
        EXPECT_EQ(record.bounced, (record.order == 0 || keys) && full > 0 ? 1u : 0u);
        if (record.order == 0) {
          EXPECT_EQ(record.straight_channels, 1u);
        }
      }
      for (lighting::GroupPlace& place : bench.places) place.lamps_apart.clear();
      bench.shade();
      EXPECT_LT(bench.differenceToTwin(), 1e-3) << "all by their columns again";
      for (const transfer::TransferRecord& record : bench.samples.tables().transfers)
        if (record.order == 0) {
          EXPECT_EQ(record.straight_channels, 0u);
        }
    }
}

TEST_F(DiffuseGpu, MatchesItsTwinWhereKeyLightsStandApart) {
  testing::BundleMaker maker(24);
  for (const std::uint32_t full : {0u, 1u, 3u})
    for (const std::uint32_t shadowed : {1u, 3u})
      for (const std::uint32_t lights : {1u, 5u}) {
        DiffuseBench bench(maker, {.order = 5,
                                   .shadowed_channels = shadowed,
                                   .full_channels = full,
                                   .clusters = 3,
                                   .lamps = 2,
                                   .cells = 1,
                                   .mapped_cells = 1,
                                   .samples = 222,
                                   .light_probes = lights});
        bench.shineByKeyLights();
        bench.uploadAll(4);
        for (const evaluate::TransferMode mode :
             {evaluate::TransferMode::Full, evaluate::TransferMode::Shadowed}) {
          bench.shade(mode);
          EXPECT_LT(bench.differenceToTwin(), 1e-3)
              << shadowed << " and " << full << " channels, " << lights << " lights";
          for (const transfer::TransferRecord& record : bench.samples.tables().transfers) {
            EXPECT_EQ(record.bounced,
                      record.order > 0 && mode == evaluate::TransferMode::Full && full > 0 ? 1u : 0u);
            EXPECT_EQ(record.straight_channels, record.order > 0 ? shadowed : 0u);
          }
        }
        bench.environment.setTurn(33.0f);
        bench.shade();
        EXPECT_LT(bench.differenceToTwin(), 1e-3) << "turned";
        // The change is undone again.
        bench.environment.setMostKeys(0);
        for (lighting::GroupPlace& place : bench.places)
          for (lighting::Incident& incident : place.incident) incident.key = nullptr;
        bench.shade();
        EXPECT_LT(bench.differenceToTwin(), 1e-3) << "no key lights";
        for (const transfer::TransferRecord& record : bench.samples.tables().transfers)
          EXPECT_EQ(record.bounced, 0u);
        bench.shineByKeyLights();
        bench.shade();
        EXPECT_LT(bench.differenceToTwin(), 1e-3) << "they are back";
        for (const transfer::TransferRecord& record : bench.samples.tables().transfers)
          EXPECT_EQ(record.bounced, record.order > 0 && full > 0 ? 1u : 0u);
      }
}

TEST_F(DiffuseGpu, BlendsSeveralLightProbesAsItsTwin) {
  testing::BundleMaker maker(21);
  for (const std::uint32_t lights : {3u, 33u})
    for (const std::uint32_t mapped : {0u, 1u}) {
      DiffuseBench bench(maker, {.order = 5,
                                 .full_channels = 3,
                                 .clusters = 5,
                                 .lamps = 2,
                                 .cells = 2,
                                 .mapped_cells = mapped,
                                 .samples = 423,
                                 .light_probes = lights});
      bench.uploadAll(7);
      bench.shade();
      EXPECT_LT(bench.differenceToTwin(), 1e-3) << lights << " lights, " << mapped << " mapped cells";
    }
}

TEST_F(DiffuseGpu, ShadesOnlyCellsWhoseLightProbesChanged) {
  testing::BundleMaker maker(22);
  DiffuseBench bench(maker, {.groups = 2, .cells = 2, .light_probes = 4});
  bench.uploadAll(7);
  bench.shade();
  bench.places[1].incident[0].version = 2;  // which no cell uses
  bench.shade();
  EXPECT_EQ(bench.samples.cellsShadedLast(), 0u);
  bench.places[1].incident[2].version = 2;
  bench.shade();
  EXPECT_EQ(bench.samples.cellsShadedLast(), 2u) << "those of the second group";
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, ProxiesSendOutWhatTheirSamplesReceive) {
  testing::BundleMaker maker(23);
  DiffuseBench bench(maker, {.order = 4,
                             .lamps = 3,
                             .groups = 3,
                             .cells = 1,
                             .mapped_cells = 1,
                             .light_probes = 5,
                             .proxy_triangles = 77});
  bench.uploadMeshes();
  bench.uploadRows();
  for (const auto& item : bench.made.proxies) bench.upload(item);
  enum class Step { Waiting, Arrived, KeyLights };
  for (const Step step : {Step::Waiting, Step::Arrived, Step::KeyLights}) {
    const bool transfer_here = step != Step::Waiting;
    if (step == Step::Arrived) bench.uploadTransfer(7);
    if (step == Step::KeyLights) {
      bench.shineByKeyLights();
      for (lighting::GroupPlace& place : bench.places)
        for (lighting::Incident& incident : place.incident) ++incident.version;
    }
    bench.shade();
    gpu::Counters counters;
    ASSERT_TRUE(bench.proxies.shade(bench.residency, bench.lights, bench.shadedGroups(), counters));
    EXPECT_EQ(counters.dispatches, 1u);
    std::vector<glm::vec4> radiance(bench.proxies.triangles().size());
    ASSERT_EQ(radiance.size(), 3u * 77u);
    bench.proxies.radiance().read(0, std::span(radiance));
    const auto samples = DiffuseBench::pagesOf<glm::vec4>(bench.residency.samples());
    for (std::size_t g = 0; g < 3; ++g) {
      glsl::ShadeProxies kernel;
      kernel.lights = bench.lights.coefficients();
      kernel.samples = samples[bench.residency.groups()[g].samples.page];
      kernel.entries = bench.proxies.entries();
      const ProxyGroupRecord& group = bench.proxies.groups()[g];
      for (uint t = group.first_triangle; t < group.first_triangle + group.triangle_count; ++t) {
        const glm::vec3 expected = kernel.proxyRadiance(group, bench.proxies.triangles()[t]);
        EXPECT_LT(glm::distance(glm::vec3(radiance[t]), expected), 1e-3f * (1.0f + glm::length(expected)))
            << "triangle " << t << (transfer_here ? " with" : " without") << " transfer"
            << (step == Step::KeyLights ? " and key lights" : "");
      }
    }
    counters = {};
    ASSERT_TRUE(bench.proxies.shade(bench.residency, bench.lights, bench.shadedGroups(), counters));
    EXPECT_EQ(counters.dispatches, 0u) << "nothing changed";
  }
}

TEST_F(DiffuseGpu, MatchesItsTwinWithMorePlanesThanLanes) {
  testing::BundleMaker maker(12);
  DiffuseBench bench(
      maker, {.order = 8, .shadowed_channels = 3, .planes = 70, .groups = 1, .cells = 2, .samples = 66});
  bench.uploadAll(70);
  bench.shade();
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, NormalMappedDrawsHaveTheLightItselfUntilTransferIsThere) {
  testing::BundleMaker maker(17);
  DiffuseBench bench(maker, {.order = 5, .lamps = 2, .cells = 1, .mapped_cells = 1});
  bench.uploadMeshes();
  bench.uploadRows();
  bench.shade();
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
  const streaming::ResidentDraw& draw = bench.residency.draws()[1];
  ASSERT_EQ(draw.outputs, 9u);
  const auto pages = DiffuseBench::pagesOf(bench.residency.radiance());
  const auto light = bench.lights.coefficients().subspan(bench.lights.firstOf(draw.group));
  for (uint j = 0; j < 9; ++j)
    EXPECT_EQ(std::bit_cast<float>(pages[draw.radiance.page][draw.radiance.word() + 3 * j]), light[j].r);
}

TEST_F(DiffuseGpu, ALampThatDimsIsShadedAgainAndUnshadowedIsDark) {
  testing::BundleMaker maker(18);
  DiffuseBench bench(maker, {.lamps = 2, .groups = 1});
  bench.uploadAll(7);
  EXPECT_EQ(bench.shade(), 5u) << "two kernels project, then the environment, the lamps, the vertices";
  EXPECT_EQ(bench.shade(), 0u);
  const auto before = DiffuseBench::pagesOf(bench.residency.radiance());
  bench.places[0].lamps[1] = glm::vec3(0.0f);
  EXPECT_EQ(bench.shade(), 5u);
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
  EXPECT_NE(DiffuseBench::pagesOf(bench.residency.radiance()), before);
  EXPECT_EQ(bench.shade(evaluate::TransferMode::Unshadowed), 1u);
  const auto unshadowed = DiffuseBench::pagesOf(bench.residency.radiance());
  bench.places[0].lamps[0] = glm::vec3(50.0f);
  bench.shade(evaluate::TransferMode::Unshadowed);
  EXPECT_EQ(DiffuseBench::pagesOf(bench.residency.radiance()), unshadowed);
}

TEST_F(DiffuseGpu, MatchesItsTwinOverSeveralPages) {
  testing::BundleMaker maker(16);
  DiffuseBench bench(maker, {.groups = 4}, /*page_bytes=*/6000);
  bench.uploadAll(7);
  EXPECT_GT(bench.residency.transfer().pageCount(), 1u);
  EXPECT_GT(bench.residency.radiance().pageCount(), 1u);
  bench.shade();
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, ShadesUnshadowedUntilTransferIsThere) {
  testing::BundleMaker maker(13);
  DiffuseBench bench(maker, {});
  bench.uploadMeshes();
  EXPECT_EQ(bench.shade(), 1u) << "vertices only";
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
  bench.uploadRows();
  bench.shade();
  // Only one of several cells is uploaded; rows that reach into the others blend in unshadowed light.
  bench.uploadCell(0, 1);
  EXPECT_EQ(bench.shade(), 3u);
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, UnshadowedModeLeavesTransferAside) {
  testing::BundleMaker maker(14);
  DiffuseBench bench(maker, {});
  bench.uploadAll(7);
  bench.shade();
  EXPECT_EQ(bench.shade(evaluate::TransferMode::Unshadowed), 1u);
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
  EXPECT_EQ(bench.shade(evaluate::TransferMode::Full), 3u);
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, WhatComesInPiecesIsShadedAsWhatComesWhole) {
  testing::BundleMaker maker(16);
  DiffuseBench bench(maker, {.order = 8,
                             .full_channels = 3,
                             .planes = 30,
                             .clusters = 24,
                             .groups = 1,
                             .cells = 1,
                             .vertices = 4001});
  std::uint32_t pieces = 0, items = 0;
  const auto bring = [&](const streaming::Ready& item) {
    ASSERT_TRUE(bench.residency.begin(0, item));
    for (++items; bench.residency.comes(0); ++pieces) {
      const Result<std::uint64_t> bytes = bench.residency.proceed(0, /*max_bytes=*/70'000);
      ASSERT_TRUE(bytes);
      ASSERT_LE(*bytes, 70'000u);
    }
  };
  for (const auto& item : bench.made.meshes) bring(item);
  bench.uploadRows();
  for (std::size_t cell = 0; cell < bench.made.codebooks.size(); ++cell) {
    for (const auto& item : bench.made.codebooks[cell]) bring(item);
    for (const auto& plane : bench.made.planes[cell]) bench.upload(plane);
  }
  EXPECT_GT(pieces, items + 2) << "or nothing was cut";
  bench.shade();
  EXPECT_LT(bench.differenceToTwin(), 1e-3);

  // A cancelled upload leaves nothing behind.
  const std::uint64_t before = bench.residency.bytesResident();
  ASSERT_TRUE(bench.residency.begin(0, bench.made.meshes.front()));
  bench.residency.cancel(0);
  EXPECT_EQ(bench.residency.bytesResident(), before);
}

TEST_F(DiffuseGpu, RunsOnlyWhenLightRotationOrResidencyChanged) {
  testing::BundleMaker maker(15);
  DiffuseBench bench(maker, {});
  bench.uploadAll(1);
  EXPECT_EQ(bench.shade(), 3u);
  EXPECT_EQ(bench.shade(), 0u) << "a still frame";
  bench.environment.setTurn(10.0f);
  EXPECT_EQ(bench.shade(), 3u) << "the light turned";
  bench.environment.setTurn(10.0f);
  EXPECT_EQ(bench.shade(), 0u);
  bench.places[1].world_from_group = maker.rotation();
  EXPECT_EQ(bench.shade(), 3u) << "one group turned";
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
  bench.upload(bench.made.planes[0][1]);
  EXPECT_EQ(bench.shade(), 3u) << "another plane arrived";
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
  EXPECT_EQ(bench.shade(), 0u);
}

}  // namespace lambent::effects::diffuse
