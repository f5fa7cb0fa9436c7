// Compares the transfer values that views show with those of the kernel as C++, and that with closed forms.
#include "runtime/evaluate/transfer_values.hpp"

#include <numbers>

#include "tests/runtime/evaluate/shading_bench.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/glsl/transfer.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::evaluate {
namespace {

using namespace lambent::glsl;
using namespace transfer;

constexpr int kOrder = 4;

#define LAMBENT_VALUE 1
struct DcKernel : Invocation {
#include "as_cpp/transfer_values.comp"
};
#undef LAMBENT_VALUE

struct ValuesBench : lambent::testing::ShadingBench {
  using ShadingBench::ShadingBench;
  TransferValues values;

  // Returns the number of dispatches.
  std::uint32_t update(const TransferQuestion& question) {
    gpu::Counters counters;
    lights.update(environment, sh::Window::Off, places, counters);
    std::vector<float> of_cells;
    for (std::size_t c = 0; c < residency.cells().size(); ++c)
      of_cells.push_back(0.25f * static_cast<float>(c));
    const Result<void> done = values.update(residency, lights, question, of_cells, {}, counters);
    EXPECT_TRUE(done) << done.error().line();
    return counters.dispatches;
  }
  std::vector<SampleValue> ask(const TransferQuestion& question) {
    update(question);
    std::vector<SampleValue> got(values.bytes() / sizeof(SampleValue));
    values.buffer().read(0, std::span(got));
    return got;
  }
  std::uint32_t firstValue(std::size_t cell) const {
    const streaming::ResidentCell& resident = residency.cells()[cell];
    return values.firstOf(resident.group) + resident.first_sample;
  }
  // Computes what ask() returned, by the kernels as C++ from the same memory.
  std::vector<SampleValue> twin(const TransferQuestion& question) {
    std::vector<SampleValue> wanted(values.bytes() / sizeof(SampleValue), {0, kNoCluster});
    TransferTable table;
    for (std::uint32_t i = 0; i < residency.cells().size(); ++i) {
      const streaming::ResidentCell& cell = residency.cells()[i];
      table.add(cell, lights, question.mode);
      if (cell.domain != Domain::Vertex) continue;
      std::vector<std::uint32_t> page(residency.transfer().page(cell.block.page).byteCount() / 4);
      residency.transfer().page(cell.block.page).read(0, std::span(page));
      for (std::uint32_t t = table.cells[i].first; t < table.transfers.size(); ++t) {
        const TransferRecord& record = table.transfers[t];
        if (record.order == 0) continue;
        const ValueCell described{.transfer = t, .first_value = firstValue(i), .cell = i, .constant = 0.0f};
        DcKernel kernel;
        kernel.cells = std::span(&described, 1);
        kernel.transfers = table.transfers;
        kernel.page = page;
        kernel.places = table.places;
        kernel.values = wanted;
        lambent::glsl::run(kernel, record.sample_count);
      }
    }
    return wanted;
  }
};

lambent::testing::RandomBundleOptions everyKind() {
  return {.order = kOrder,
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

float valueOf(const SampleValue& value) {
  return std::bit_cast<float>(value.value_bits);
}

}  // namespace

using TransferValuesTest = lambent::testing::GpuTest;

TEST_F(TransferValuesTest, AreThoseOfTheKernelAsCppForEveryKindOfSample) {
  lambent::testing::BundleMaker maker(11);
  ValuesBench bench(maker, everyKind());
  bench.uploadTransfer();
  for (const TransferMode mode : {TransferMode::Full, TransferMode::Shadowed}) {
    const TransferQuestion question{.value = TransferValue::Dc, .mode = mode};
    const auto got = bench.ask(question), wanted = bench.twin(question);
    double worst = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      ASSERT_EQ(got[i].cluster, wanted[i].cluster);
      worst = lambent::testing::larger(worst, double{std::abs(valueOf(got[i]) - valueOf(wanted[i]))});
      largest = lambent::testing::larger(largest, double{std::abs(valueOf(wanted[i]))});
    }
    EXPECT_GT(largest, 0.01);
    EXPECT_LT(worst, 1e-5 * largest) << (mode == TransferMode::Full ? "full" : "shadowed");
  }
}

TEST_F(TransferValuesTest, ClustersAndWhatCellsSayAreExact) {
  lambent::testing::BundleMaker maker(12);
  ValuesBench bench(maker, everyKind());
  bench.uploadTransfer();
  const auto values = bench.ask({.value = TransferValue::OfCell});
  std::size_t surfaces = 0;
  for (std::size_t cell = 0; cell < bench.residency.cells().size(); ++cell) {
    if (bench.residency.cells()[cell].domain != transfer::Domain::Vertex) continue;
    for (const std::uint32_t place : bench.made.codebooks[cell][0].positions) {
      ++surfaces;
      const SampleValue& value = values[bench.firstValue(cell) + (place & 0xffffu)];
      ASSERT_EQ(value.cluster, static_cast<std::uint32_t>(cell) << 16u | place >> 16u);
      ASSERT_EQ(valueOf(value), 0.25f * static_cast<float>(cell));
    }
  }
  EXPECT_EQ(values.size(), surfaces) << "grids around bodies have no surface to be seen on";
}

TEST_F(TransferValuesTest, ASampleWhoseCodesAreNotHereHasNone) {
  lambent::testing::BundleMaker maker(13);
  ValuesBench bench(maker, {.clusters = 2, .groups = 1, .cells = 2});
  bench.uploadCell(1);
  auto values = bench.ask({.value = TransferValue::Dc});
  EXPECT_EQ(values[bench.firstValue(0)].cluster, kNoCluster);
  EXPECT_NE(values[bench.firstValue(1)].cluster, kNoCluster);
  bench.uploadCell(0);
  values = bench.ask({.value = TransferValue::Dc});
  EXPECT_NE(values[bench.firstValue(0)].cluster, kNoCluster) << "it has arrived";
  values = bench.ask({.value = TransferValue::Dc, .mode = TransferMode::Unshadowed});
  EXPECT_EQ(values[bench.firstValue(0)].cluster, kNoCluster) << "no transfer counts";
}

TEST_F(TransferValuesTest, TheSameQuestionTwiceDispatchesNothing) {
  lambent::testing::BundleMaker maker(14);
  ValuesBench bench(maker, {.clusters = 2});
  bench.uploadTransfer();
  const TransferQuestion question{.value = TransferValue::Dc};
  EXPECT_GT(bench.update(question), 0u);
  EXPECT_EQ(bench.update(question), 0u);
  EXPECT_GT(bench.update({.value = TransferValue::Dc, .mode = TransferMode::Shadowed}), 0u);
}

TEST(TransferValueKernels, OpenSurfacesOfEveryKindHaveTheSameNumbers) {
  constexpr float kFourPi = 4.0f * std::numbers::pi_v<float>;
  constexpr float kCosineOverPi[] = {1.0f, 2.0f / 3.0f, 0.25f, 0.0f};  // A_l/pi
  TransferRecord plain{};
  plain.columns = kOrder * kOrder;
  plain.channels = plain.outputs = 1;
  plain.order = kOrder;
  TransferRecord mapped = plain, visibility = plain;
  mapped.outputs = 9;
  visibility.outputs = 25;
  visibility.visibility = 1;
  std::vector<float> row(16, 0.0f), matrix(9 * 16, 0.0f), open(36, 0.0f);
  // E/pi at the normal z is (A_l/pi) y_l0.
  for (std::uint32_t l = 0; l < kOrder; ++l)
    row[l * l + l] = kCosineOverPi[l] * std::sqrt(static_cast<float>(2 * l + 1) / kFourPi);
  for (std::uint32_t j = 0; j < 9; ++j) matrix[j * 16 + j] = 1.0f;
  open[0] = std::sqrt(kFourPi);
  const auto dcOf = [&](const TransferRecord& record, std::span<const float> vector) {
    std::vector<std::uint32_t> words;
    for (const float value : vector) words.push_back(std::bit_cast<std::uint32_t>(value));
    DcKernel kernel;
    kernel.page = words;
    return kernel.dcOf(record, {}, 0);
  };
  const float dc = std::sqrt(1.0f / kFourPi);
  EXPECT_NEAR(dcOf(plain, row), dc, 1e-6f);
  EXPECT_NEAR(dcOf(mapped, matrix), dc, 1e-6f);
  EXPECT_NEAR(dcOf(visibility, open), dc, 1e-6f);
}

}  // namespace lambent::evaluate
