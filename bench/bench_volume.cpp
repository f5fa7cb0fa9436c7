// Measures the parts of a volume's bake: rays through its density, rows of weights, and the solver. The
// volume is the procedural cloud at 30 per metre, with transfer of 24 x 24 x 24.
//   bench_volume [--benchmark_...]
#include <limits>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "baker/effects/volume/volume.hpp"
#include "baker/effects/volume/volume_rays.hpp"
#include "baker/import/density_file.hpp"

namespace {

using namespace lambent::baker;

struct Cloud {
  std::vector<float> values;
  std::shared_ptr<const DensityField> field;

  Cloud() {
    const DensityGrid grid = proceduralCloud(7);
    values = grid.values;
    for (float& value : values) value *= 30.0f;
    field = std::make_shared<DensityField>(grid.size, values, glm::mat4(grid.file_from_grid));
  }
};

// Measures rays per second on one core, from the samples of the grid in all directions. The limit is memory:
// a ray reads eight floats in each cell that it crosses.
void rays(benchmark::State& state) {
  const Cloud cloud;
  const TransferGrid grid(*cloud.field, cloud.values, glm::uvec3(24));
  const SphereTable table(1024, 1);
  std::size_t sample = 0;
  for (auto _ : state) {
    const glm::vec3 origin = grid.place(sample);
    sample = (sample + 101) % grid.samples();
    for (const glm::vec3& direction : table.directions())
      benchmark::DoNotOptimize(
          cloud.field->opticalDepth(origin, direction, std::numeric_limits<float>::infinity()));
  }
  state.counters["rays"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 1024.0, benchmark::Counter::kIsRate);
}

void whole(benchmark::State& state) {
  const Cloud cloud;
  const VolumeSettings settings{.grid = glm::uvec3(24)};
  for (auto _ : state) {
    Progress progress;
    const auto transfer =
        bakeVolumeTransfer({cloud.field, cloud.values, glm::vec3(1.0f)}, settings, {}, {progress});
    progress.end();
    for (const Progress::Stage& stage : progress.finished()) state.counters[stage.name] = stage.seconds;
    state.counters["samples"] = static_cast<double>(transfer->grid.samples());
    state.counters["steps"] = transfer->iterations;
  }
}

BENCHMARK(rays);
BENCHMARK(whole)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
