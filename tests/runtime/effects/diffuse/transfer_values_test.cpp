// Compares the transfer values that views show with vectors from the bundle's own decoder.
#include "runtime/evaluate/transfer_values.hpp"

#include <cstring>

#include <gtest/gtest.h>

#include "runtime/transfer/transfer_measures.hpp"
#include "tests/runtime/effects/diffuse/shading_bench.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::effects::diffuse {
namespace {

// Runs TransferValues in the place of an effect that shades.
struct Asked {
  evaluate::TransferValues values;
  Result<void> shade(streaming::Residency& residency, const lighting::GroupLights& lights,
                     const evaluate::TransferQuestion& question, gpu::Counters& counters) {
    std::vector<float> of_cells;
    for (std::size_t c = 0; c < residency.cells().size(); ++c)
      of_cells.push_back(0.25f * static_cast<float>(c));
    return values.update(residency, lights, question, of_cells, {}, counters);
  }
};

struct ValuesBench : testing::ShadingBench<Asked> {
  using ShadingBench::ShadingBench;

  std::vector<evaluate::SampleValue> ask(const evaluate::TransferQuestion& question) {
    shadeIn(question);
    std::vector<evaluate::SampleValue> values(effect.values.bytes() / sizeof(evaluate::SampleValue));
    effect.values.buffer().read(0, std::span(values));
    return values;
  }
  // Returns transfer t of a cell, sample-major, as the bundle decodes it.
  std::vector<float> decoded(std::size_t cell, std::size_t t, std::vector<std::uint32_t>& cluster_of) const {
    const streaming::CodebookChunk& ready = made.codebooks[cell][t];
    cluster_of.resize(ready.positions.size());
    for (const std::uint32_t place : ready.positions) cluster_of[place & 0xffffu] = place >> 16u;
    std::vector<std::vector<std::uint32_t>> planes;
    for (const streaming::PlaneChunk& plane : made.planes[cell]) {
      if (plane.transfer.value != t) continue;
      const bundle::CellTransfer& described = transferOf(cell, t);
      const std::size_t bytes = described.planes[plane.plane.value].bits / 8;
      auto& codes = planes.emplace_back(plane.codes.size() / bytes, 0u);
      for (std::size_t i = 0; i < codes.size(); ++i)
        std::memcpy(&codes[i], plane.codes.data() + i * bytes, bytes);
    }
    return transfer::decodeTransfer(transferOf(cell, t).shape, ready.codebook, cluster_of, planes);
  }
  const bundle::CellTransfer& transferOf(std::size_t cell, std::size_t t) const {
    const streaming::ResidentCell& resident = residency.cells()[cell];
    const std::uint32_t first = residency.groups()[resident.group].first_cell;
    return made.description.groups[resident.group].cells[cell - first].transfers[t];
  }
  std::size_t firstValue(std::size_t cell) const {
    const streaming::ResidentCell& resident = residency.cells()[cell];
    return effect.values.firstOf(resident.group) + resident.first_sample;
  }
};

testing::RandomBundleOptions everyKind() {
  return {.order = 4,
          .shadowed_channels = 1,
          .full_channels = 3,
          .clusters = 3,
          .lamps = 2,
          .cells = 2,
          .mapped_cells = 1,
          .glossy_cells = 1,
          .glossy_bands = 4,
          .neighborhood_cells = 1,
          .bounced = true};
}

float valueOf(const evaluate::SampleValue& value) {
  return std::bit_cast<float>(value.value_bits);
}

}  // namespace

using TransferValuesTest = testing::GpuTest;

TEST_F(TransferValuesTest, DcAndBandsAreThoseOfTheDecodedVectorsOfEveryKindOfSample) {
  testing::BundleMaker maker(11);
  ValuesBench bench(maker, everyKind());
  bench.uploadTransfer();
  for (const evaluate::TransferMode mode : {evaluate::TransferMode::Full, evaluate::TransferMode::Shadowed})
    for (const int band : {-1, 0, 1, 2, 3}) {
      const bool dc = band < 0;
      const auto values =
          bench.ask({.value = dc ? evaluate::TransferValue::Dc : evaluate::TransferValue::BandEnergy,
                     .band = dc ? 0u : static_cast<std::uint32_t>(band),
                     .mode = mode});
      double worst = 0.0, largest = 0.0;
      for (std::size_t cell = 0; cell < bench.residency.cells().size(); ++cell) {
        if (bench.residency.cells()[cell].domain != transfer::Domain::Vertex) continue;
        for (std::size_t t = 0; t < bench.made.codebooks[cell].size(); ++t) {
          const transfer::TransferShape& shape = bench.transferOf(cell, t).shape;
          if (shape.order == 0 || t > 0) continue;
          std::vector<std::uint32_t> cluster_of;
          const std::vector<float> vectors = bench.decoded(cell, t, cluster_of);
          // Bounced light of glossy surfaces has a transfer of its own, of which only DC adds up.
          const bool bounced = dc && mode == evaluate::TransferMode::Full && shape.isVisibility();
          std::vector<std::uint32_t> others;
          const std::vector<float> bounces = bounced ? bench.decoded(cell, 1, others) : std::vector<float>();
          const transfer::TransferBlock block =
              transfer::blockOf(shape, mode == evaluate::TransferMode::Full);
          for (std::size_t s = 0; s < cluster_of.size(); ++s) {
            const auto vector = std::span(vectors).subspan(s * shape.size(), shape.size());
            float expected =
                dc ? transfer::transferDc(shape, block, vector)
                   : transfer::transferBandEnergy(shape, block, vector, static_cast<std::uint32_t>(band));
            if (bounced) {
              const transfer::TransferShape& added = bench.transferOf(cell, 1).shape;
              expected += transfer::transferDc(added, transfer::blockOf(added, true),
                                               std::span(bounces).subspan(s * added.size(), added.size()));
            }
            const float got = valueOf(values[bench.firstValue(cell) + s]);
            worst = testing::larger(worst, static_cast<double>(std::abs(got - expected)));
            largest = testing::larger(largest, static_cast<double>(std::abs(expected)));
          }
        }
      }
      EXPECT_GT(largest, 0.01) << band;
      EXPECT_LT(worst, 1e-5 * largest)
          << "band " << band << (mode == evaluate::TransferMode::Full ? " full" : " shadowed");
    }
}

TEST_F(TransferValuesTest, ClustersAndWhatCellsSayAreExact) {
  testing::BundleMaker maker(12);
  ValuesBench bench(maker, everyKind());
  bench.uploadTransfer();
  const auto values = bench.ask({.value = evaluate::TransferValue::OfCell});
  std::size_t surfaces = 0;
  for (std::size_t cell = 0; cell < bench.residency.cells().size(); ++cell) {
    if (bench.residency.cells()[cell].domain != transfer::Domain::Vertex) continue;
    std::vector<std::uint32_t> cluster_of;
    static_cast<void>(bench.decoded(cell, 0, cluster_of));
    for (std::size_t s = 0; s < cluster_of.size(); ++s, ++surfaces) {
      const evaluate::SampleValue& value = values[bench.firstValue(cell) + s];
      ASSERT_EQ(value.cluster, static_cast<std::uint32_t>(cell) << 16u | cluster_of[s]);
      ASSERT_EQ(valueOf(value), 0.25f * static_cast<float>(cell));
    }
  }
  EXPECT_EQ(values.size(), surfaces) << "grids around bodies have no surface to be seen on";
}

TEST_F(TransferValuesTest, ASampleWhoseCodesAreNotHereHasNone) {
  testing::BundleMaker maker(13);
  ValuesBench bench(maker, {.clusters = 2, .groups = 1, .cells = 2});
  bench.uploadCell(1);
  auto values = bench.ask({.value = evaluate::TransferValue::Dc});
  EXPECT_EQ(values[bench.firstValue(0)].cluster, evaluate::kNoCluster);
  EXPECT_NE(values[bench.firstValue(1)].cluster, evaluate::kNoCluster);
  bench.uploadCell(0);
  values = bench.ask({.value = evaluate::TransferValue::Dc});
  EXPECT_NE(values[bench.firstValue(0)].cluster, evaluate::kNoCluster) << "it has arrived";
  values = bench.ask({.value = evaluate::TransferValue::Dc, .mode = evaluate::TransferMode::Unshadowed});
  EXPECT_EQ(values[bench.firstValue(0)].cluster, evaluate::kNoCluster) << "no transfer counts";
}

TEST_F(TransferValuesTest, TheSameQuestionTwiceDispatchesNothing) {
  testing::BundleMaker maker(14);
  ValuesBench bench(maker, {.clusters = 2});
  bench.uploadTransfer();
  const evaluate::TransferQuestion question{.value = evaluate::TransferValue::BandEnergy, .band = 1};
  EXPECT_GT(bench.shadeIn(question), 0u);
  EXPECT_EQ(bench.shadeIn(question), 0u);
  EXPECT_GT(
      bench.shadeIn(evaluate::TransferQuestion{.value = evaluate::TransferValue::BandEnergy, .band = 2}), 0u);
}

TEST(TransferMeasures, OpenSurfacesOfEveryKindHaveTheSameNumbers) {
  constexpr int kOrder = 5;
  const transfer::TransferShape plain{.order = kOrder}, mapped{.order = kOrder, .outputs = 9},
      visibility{.order = kOrder, .outputs = 25, .visibility_bands = 9};
  std::vector<float> row(plain.size(), 0.0f), matrix(mapped.size(), 0.0f), open(visibility.size(), 0.0f);
  // E/pi at the normal z is (A_l/pi) y_l0.
  for (std::uint32_t l = 0; l < kOrder; ++l)
    row[l * l + l] = transfer::kCosineOverPi[l] *
                     std::sqrt(static_cast<float>(2 * l + 1) / (4.0f * std::numbers::pi_v<float>));
  for (std::uint32_t j = 0; j < 9; ++j) matrix[j * kOrder * kOrder + j] = 1.0f;
  open[0] = std::sqrt(4.0f * std::numbers::pi_v<float>);
  EXPECT_NEAR(transfer::transferDc(plain, {}, row), transfer::openDc(), 1e-6f);
  EXPECT_NEAR(transfer::transferDc(mapped, {}, matrix), transfer::openDc(), 1e-6f);
  EXPECT_NEAR(transfer::transferDc(visibility, {}, open), transfer::openDc(), 1e-6f);
  for (std::uint32_t band = 0; band < 3; ++band) {
    EXPECT_NEAR(transfer::transferBandEnergy(plain, {}, row, band), transfer::openBandEnergy(band), 1e-6f);
    EXPECT_NEAR(transfer::transferBandEnergy(mapped, {}, matrix, band), transfer::openBandEnergy(band),
                1e-6f);
    EXPECT_NEAR(transfer::transferBandEnergy(visibility, {}, open, band), transfer::openBandEnergy(band),
                1e-6f);
  }
}

}  // namespace lambent::effects::diffuse
