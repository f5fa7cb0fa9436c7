// Writes shaded points into the texture and reads them back, and compares with the shaders as C++ on random
// data.

#include <random>

#include <glm/geometric.hpp>

#include "lambent_effects_neighborhood_embedded.hpp"
#include "runtime/effects/neighborhood/neighborhood.hpp"
#include "test_effects_neighborhood_gpu_embedded.hpp"
#include "tests/runtime/effects/neighborhood/neighborhood_kernels.hpp"
#include "tests/runtime/evaluate/shading_bench.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::effects::neighborhood {

namespace {

struct Bench : lambent::testing::ShadingBench {
  Neighborhood neighborhood;

  Bench(lambent::testing::BundleMaker& maker, const lambent::testing::RandomBundleOptions& options,
        const glm::uvec3& size)
      : ShadingBench(maker, options) {
    std::vector<Grid> grids;
    for (std::uint32_t g = 0; g < options.groups; ++g)
      grids.push_back(
          {.group = g,
           .points = {.size = size, .bounds_min = glm::vec3(-1.0f), .bounds_max = glm::vec3(1.0f)}});
    neighborhood.setGrids(std::move(grids), residency);
    uploadMeshes();
    uploadRows();
  }
  gpu::Counters run(evaluate::TransferMode mode = evaluate::TransferMode::Full) {
    gpu::Counters before, counters;
    shadeSamples(mode, {.vectors = false}, before);
    const Result<void> done = neighborhood.update(residency, lights, samples, counters);
    EXPECT_TRUE(done) << done.error().line();
    return counters;
  }
  glsl::Texels atlas() const {
    glsl::Texels result(neighborhood.atlasSize());
    glGetTextureImage(neighborhood.texture(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(result.values.size() * sizeof(glm::vec4)), result.values.data());
    return result;
  }
  // Computes the same texels by the kernel as C++, from the same samples.
  glsl::Texels twin() const {
    glsl::Texels result(neighborhood.atlasSize());
    for (const Grid& grid : neighborhood.grids()) {
      const streaming::ResidentGroup& group = residency.groups()[grid.group];
      auto& arena = const_cast<streaming::Residency&>(residency).samples();
      std::vector<glm::vec4> values(arena.page(group.samples.page).byteCount() / sizeof(glm::vec4));
      arena.page(group.samples.page).read(0, std::span(values));
      uint first_point = 0;
      for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c) {
        const streaming::ResidentCell& cell = residency.cells()[c];
        if (cell.domain != transfer::Domain::GridPoint) continue;
        glsl::write(result,
                    {.grid = grid.place,
                     .first_output = cell.first_output,
                     .first_point = first_point,
                     .point_count = cell.sample_count,
                     .pad = 0},
                    values);
        first_point += cell.sample_count;
      }
    }
    return result;
  }
};

struct Query {
  glm::vec4 place, normal;
};

}  // namespace

using NeighborhoodGpu = lambent::testing::GpuTest;

TEST_F(NeighborhoodGpu, WritesAndLooksUpAsItsTwinDoes) {
  lambent::testing::BundleMaker maker(51);
  std::mt19937 random(52);
  std::uniform_real_distribution<float> uniform(-0.2f, 1.2f);
  std::normal_distribution<float> normal;
  constexpr gpu::FindText kShaders[] = {&embedded::test_effects_neighborhood_gpu::find,
                                        &embedded::lambent_effects_neighborhood::find};
  const Result<gpu::Program> probe =
      gpu::Program::create("probe", {{GL_COMPUTE_SHADER, "neighborhood_probe.comp"}}, kShaders);
  ASSERT_TRUE(probe) << probe.error().line();
  for (const std::uint32_t bands : {3u, 5u}) {
    const glm::uvec3 size(7, 5, 6);  // two cells of 105 points
    Bench bench(
        maker, {.order = 5, .cells = 1, .neighborhood_cells = 2, .neighborhood_bands = bands, .samples = 105},
        size);
    bench.uploadTransfer();
    EXPECT_EQ(bench.run().dispatches, 1u);
    EXPECT_EQ(bench.neighborhood.gridsWrittenLast(), 2u);
    const glsl::Texels got = bench.atlas(), wanted = bench.twin();
    glsl::Lookup lookup{.atlas = got};
    float largest = 0.0f;
    for (std::size_t i = 0; i < got.values.size(); ++i)
      for (int c = 0; c < 4; ++c) {
        largest = testing::larger(largest, std::abs(wanted.values[i][c]));
        ASSERT_NEAR(got.values[i][c], wanted.values[i][c],
                    1e-3f * std::max(1.0f, std::abs(wanted.values[i][c])));
      }
    EXPECT_GT(largest, 0.01f);

    for (const Grid& grid : bench.neighborhood.grids()) {
      std::vector<Query> queries;
      for (int i = 0; i < 333; ++i)
        queries.push_back(
            {glm::vec4(glm::vec3(size - 1u) * glm::vec3(uniform(random), uniform(random), uniform(random)),
                       0.0f),
             glm::vec4(glm::normalize(glm::vec3(normal(random), normal(random), normal(random))), 0.0f)});
      gpu::Table in("queries"), grids("grids"), out("results");
      in.assign(std::span<const Query>(queries));
      grids.assign(std::span<const GridPlace>(&grid.place, 1));
      out.reserve(2 * queries.size() * sizeof(glm::vec4));
      probe->use();
      in.bindStorage(0);
      grids.bindStorage(1);
      out.bindStorage(2);
      bench.neighborhood.bind();
      glDispatchCompute(static_cast<GLuint>(queries.size() / 64 + 1), 1, 1);
      glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
      std::vector<glm::vec4> results(2 * queries.size());
      out.buffer().read(0, std::span(results));
      for (std::size_t i = 0; i < queries.size(); ++i) {
        const glm::vec3 place(queries[i].place), n(queries[i].normal);
        const glm::vec3 received = lookup.gridIrradiance(place, grid.place, n);
        const glm::vec4 last = lookup.gridOutput(place, grid.place, grid.place.outputs - 1);
        EXPECT_NEAR(results[2 * i].a, lookup.gridShare(place, grid.place), 1e-5f);
        // Samplers may place texels to 1/256.
        const float tolerance = 0.01f * grid.place.scale * largest;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(results[2 * i][c], received[c], tolerance);
        for (int c = 0; c < 4; ++c) EXPECT_NEAR(results[2 * i + 1][c], last[c], tolerance);
      }
    }
  }
}

TEST_F(NeighborhoodGpu, IsReadyOnceAllHasArrivedAndWritesOnlyWhatChanged) {
  lambent::testing::BundleMaker maker(53);
  Bench bench(maker, {.groups = 2, .cells = 1, .neighborhood_cells = 2, .samples = 105}, {7, 5, 6});
  bench.run();
  EXPECT_FALSE(bench.neighborhood.grids()[0].ready) << "nothing has arrived";
  bench.uploadCell(1);
  bench.run();
  EXPECT_FALSE(bench.neighborhood.grids()[0].ready) << "half of it";
  const std::uint64_t version = bench.neighborhood.version();
  bench.uploadCell(2);
  bench.run();
  EXPECT_TRUE(bench.neighborhood.grids()[0].ready);
  EXPECT_FALSE(bench.neighborhood.grids()[1].ready);
  EXPECT_GT(bench.neighborhood.version(), version);
  for (const std::size_t cell : {0u, 3u, 4u, 5u}) bench.uploadCell(cell);
  bench.run();
  EXPECT_TRUE(bench.neighborhood.grids()[1].ready);
  EXPECT_EQ(bench.run().dispatches, 0u) << "a still frame";
  EXPECT_EQ(bench.neighborhood.gridsWrittenLast(), 0u);
  bench.places[1].world_from_group = maker.rotation();
  EXPECT_EQ(bench.run().dispatches, 1u);
  EXPECT_EQ(bench.neighborhood.gridsWrittenLast(), 1u) << "of the group that turned";
  bench.environment.setTurn(20.0f);
  bench.run();
  EXPECT_EQ(bench.neighborhood.gridsWrittenLast(), 2u);
  bench.run(evaluate::TransferMode::Unshadowed);
  for (const glm::vec4& texel : bench.atlas().values) ASSERT_EQ(texel, glm::vec4(0.0f));
}

TEST_F(NeighborhoodGpu, HoldsNothingWithoutGrids) {
  lambent::testing::BundleMaker maker(54);
  Bench bench(maker, {.groups = 2, .cells = 1, .samples = 105}, {7, 5, 6});
  bench.neighborhood.setGrids({}, bench.residency);
  bench.uploadTransfer();
  EXPECT_EQ(bench.run().dispatches, 0u);
  EXPECT_EQ(bench.neighborhood.texture(), 0u);
}

}  // namespace lambent::effects::neighborhood
