// Kernels against their CPU twin on random codes and lights, and what makes them run.
#include <algorithm>

#include <gtest/gtest.h>

#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/effects/diffuse/diffuse_ref.hpp"
#include "tests/runtime/effects/diffuse/diffuse_fixture.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::effects::diffuse {
namespace {

struct Bench {
  streaming::Residency residency;
  Diffuse diffuse;
  lighting::GroupLights lights;
  testing::RandomBundle made;
  std::vector<lighting::GroupPlace> places;
  lighting::Environment environment = *lighting::Environment::create(
      {spec::SunLight{
           .azimuth_deg = 30, .elevation_deg = 40, .angle_deg = 25, .radiance = {3.0f, 2.0f, 1.0f}},
       spec::ConstantLight{.radiance = {0.2f, 0.3f, 0.5f}}});

  Bench(testing::BundleMaker& maker, const testing::RandomBundleOptions& options,
        std::uint64_t page_bytes = gpu::Arena::kMaxPageBytes)
      : residency(page_bytes), made(maker.make(options)) {
    EXPECT_TRUE(residency.add(made.description));
    for (std::uint32_t g = 0; g < options.groups; ++g)
      places.push_back({.world_from_group = maker.rotation(), .order = options.order, .light_columns = 0});
  }
  void upload(const streaming::Ready& item) { ASSERT_TRUE(residency.upload(0, item)); }
  void uploadMeshes() {
    for (const auto& item : made.meshes) upload(item);
  }
  void uploadRows() {
    for (const auto& item : made.rows) upload(item);
  }
  // Bases, and of each cell's planes the first `count`.
  void uploadTransfer(std::uint32_t count) {
    for (const auto& item : made.bases) upload(item);
    for (const auto& planes : made.planes)
      for (std::uint32_t j = 0; j < std::min<std::size_t>(count, planes.size()); ++j) upload(planes[j]);
  }
  std::uint32_t shade(TransferMode mode = TransferMode::Full) {
    gpu::Counters counters;
    lights.update(environment, sh::Window::Off, places, counters);
    const Result<void> shaded = diffuse.shade(residency, lights, mode, counters);
    EXPECT_TRUE(shaded) << shaded.error().line();
    return counters.dispatches;
  }

  using Pages = std::vector<std::vector<uint>>;
  static Pages pagesOf(gpu::Arena& arena) {
    Pages pages(std::max(arena.pageCount(), 1u));
    for (std::uint32_t i = 0; i < arena.pageCount(); ++i) {
      pages[i].resize(arena.page(i).byteCount() / 4);
      arena.page(i).read(0, std::span(pages[i]));
    }
    return pages;
  }

  // Largest difference to the twin relative to the largest value there is.
  double differenceToTwin() {
    const Pages transfer = pagesOf(residency.transfer()), rows = pagesOf(residency.rows()),
                geometry = pagesOf(residency.geometry()), radiance = pagesOf(residency.radiance());
    const Tables& tables = diffuse.tables();
    std::vector<std::vector<glm::vec4>> samples;
    for (std::uint32_t i = 0; i < residency.samples().pageCount(); ++i)
      samples.emplace_back(residency.samples().page(i).byteCount() / 16, glm::vec4(0.0f));
    std::vector<Product> products(tables.product_count);
    for (std::size_t i = 0; i < tables.cells.size(); ++i) {
      const streaming::ResidentCell& resident = residency.cells()[i];
      if (!resident.usable()) continue;
      const CellRecord& cell = tables.cells[i];
      ref::Memory memory;
      memory.lights = lights.coefficients();
      memory.transfer = transfer[resident.block.page];
      ref::projectCell(memory, cell, tables.vectors, products);
      for (uint s = 0; s < cell.sample_count; ++s)
        samples[residency.groups()[resident.group].samples.page][cell.first_output + s] =
            ref::shadeSample(memory, cell, products, s);
    }
    double difference = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < tables.draws.size(); ++i) {
      const streaming::ResidentDraw& resident = residency.draws()[i];
      const DrawRecord& draw = tables.draws[i];
      const ref::Memory memory{.lights = lights.coefficients(),
                               .transfer = {},
                               .samples = samples[residency.groups()[resident.group].samples.page],
                               .rows = rows[resident.rows.page],
                               .geometry = geometry[residency.meshes()[resident.mesh].block.page]};
      const std::vector<uint>& result = radiance[resident.radiance.page];
      for (uint v = 0; v < draw.vertex_count; ++v) {
        const glm::vec3 expected = ref::shadeVertex(memory, draw, v);
        for (int k = 0; k < 3; ++k) {
          const auto got = std::bit_cast<float>(result[draw.radiance_word + 3 * v + static_cast<uint>(k)]);
          largest = std::max<double>(largest, std::abs(expected[k]));
          difference = std::max<double>(difference, std::abs(got - expected[k]));
        }
      }
    }
    return difference / largest;
  }
};

}  // namespace

using DiffuseGpu = testing::GpuTest;

TEST_F(DiffuseGpu, MatchesItsTwinAtEveryOrderAndPrefix) {
  testing::BundleMaker maker(11);
  for (std::uint32_t order = 1; order <= 8; ++order)
    for (const std::uint32_t prefix : {1u, 4u, 7u}) {
      Bench bench(maker, {.order = order, .channels = order % 2 == 0 ? 3u : 1u, .samples = 97 + order});
      bench.uploadMeshes();
      bench.uploadRows();
      bench.uploadTransfer(prefix);
      bench.shade();
      EXPECT_LT(bench.differenceToTwin(), 1e-3) << "order " << order << ", planes " << prefix;
    }
}

TEST_F(DiffuseGpu, MatchesItsTwinWithMorePlanesThanLanes) {
  testing::BundleMaker maker(12);
  Bench bench(maker, {.order = 8, .channels = 3, .planes = 70, .groups = 1, .cells = 2, .samples = 66});
  bench.uploadMeshes();
  bench.uploadRows();
  bench.uploadTransfer(70);
  bench.shade();
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, MatchesItsTwinOverSeveralPages) {
  testing::BundleMaker maker(16);
  Bench bench(maker, {.groups = 4}, /*page_bytes=*/6000);
  bench.uploadMeshes();
  bench.uploadRows();
  bench.uploadTransfer(7);
  EXPECT_GT(bench.residency.transfer().pageCount(), 1u);
  EXPECT_GT(bench.residency.radiance().pageCount(), 1u);
  bench.shade();
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, ShadesUnshadowedUntilTransferIsThere) {
  testing::BundleMaker maker(13);
  Bench bench(maker, {});
  bench.uploadMeshes();
  EXPECT_EQ(bench.shade(), 1u) << "vertices only";
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
  bench.uploadRows();
  bench.shade();
  // One cell of several: rows that reach into the others mix in the unshadowed light.
  bench.upload(bench.made.bases[0]);
  bench.upload(bench.made.planes[0][0]);
  EXPECT_EQ(bench.shade(), 3u);
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, UnshadowedModeLeavesTransferAside) {
  testing::BundleMaker maker(14);
  Bench bench(maker, {});
  bench.uploadMeshes();
  bench.uploadRows();
  bench.uploadTransfer(7);
  bench.shade();
  EXPECT_EQ(bench.shade(TransferMode::Unshadowed), 1u);
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
  EXPECT_EQ(bench.shade(TransferMode::Full), 3u);
  EXPECT_LT(bench.differenceToTwin(), 1e-3);
}

TEST_F(DiffuseGpu, RunsOnlyWhenLightRotationOrResidencyChanged) {
  testing::BundleMaker maker(15);
  Bench bench(maker, {});
  bench.uploadMeshes();
  bench.uploadRows();
  bench.uploadTransfer(1);
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
