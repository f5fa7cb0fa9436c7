// Measures a whole bake, with the seconds of each stage as counters.
//   bench_bake [--scene=FILE.glb] [--benchmark_...]; the default scene is the shipped gallery.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>

#include "baker/bake/bake.hpp"
#include "baker/import/gltf.hpp"
#include "bench/scene_argument.hpp"

namespace {

using namespace lambent::baker;

void bakeWhole(benchmark::State& state, const std::string& file) {
  const auto output = std::filesystem::temp_directory_path() / "lambent-bench-bake.lmb.glb";
  for (auto _ : state) {
    Progress progress;
    progress.begin("import");
    const auto scene = importScene(file);
    if (!scene) {
      std::fprintf(stderr, "bench_bake: %s\n", scene.error().line().c_str());
      std::exit(1);
    }
    const auto report = bake(*scene, {}, output, {progress});
    double seconds = 0.0;
    for (const Progress::Stage& stage : report->stages) seconds += stage.seconds;
    state.SetIterationTime(seconds);
    for (const Progress::Stage& stage : report->stages)
      state.counters[stage.name] += stage.seconds / static_cast<double>(state.max_iterations);
  }
  std::error_code ignored;
  std::filesystem::remove(output, ignored);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = takeSceneArgument(argc, argv);
  benchmark::Initialize(&argc, argv);
  benchmark::RegisterBenchmark("bake/standard", [file](benchmark::State& state) { bakeWhole(state, file); })
      ->UseManualTime()
      ->Unit(benchmark::kSecond)
      ->Iterations(3);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
