// Measures glossy transport against diffuse transport of the same mesh, in one run on one thread: rays per
// second of pass 0, and seconds of the first bounce. The glossy bake turns the group's first material into a
// metal; its kernels are Lambert's (the cost of real ones comes on top).
//   bench_glossy [--scene=FILE.glb] [--benchmark_...]; the default scene is the shipped gallery.
#include <ctime>
#include <string>

#include <benchmark/benchmark.h>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/jobs/parallel.hpp"
#include "bench/group_workload.hpp"
#include "bench/scene_argument.hpp"

namespace {

using namespace lambent;
using namespace lambent::baker;

constexpr std::size_t kRays = 512;

// Returns processor time. On one thread it equals wall time if nothing else runs, and is steadier if
// something does.
double secondsSince(std::clock_t start) {
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

struct Timed {
  double rays = 0.0, direct_seconds = 0.0, bounce_seconds = 0.0;
  double perSecond() const { return rays / direct_seconds; }
};

Timed run(const GroupWorkload& work, const ExitKernels& kernels, bool hits) {
  Progress progress;
  const DirectPass pass(work.view(), {.order = 5,
                                      .rays = kRays,
                                      .keep_hits = hits,
                                      .hit_memory = std::size_t{4} << 30,
                                      .colored_kernels = !kernels.grey});
  Timed timed;
  auto start = std::clock();
  auto direct = bakeDirect(pass, {progress});
  timed.direct_seconds = secondsSince(start);
  timed.rays =
      static_cast<double>(direct->of(SurfacePart::Matte).rays + direct->of(SurfacePart::Glossy).rays);
  if (!hits) return timed;
  start = std::clock();
  bakeBounces({.pass = pass, .direct = *direct, .kernels = work.samples.glossy.empty() ? nullptr : &kernels},
              {.bounces = 1}, {progress});
  timed.bounce_seconds = secondsSince(start);
  return timed;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = takeSceneArgument(argc, argv);
  benchmark::Initialize(&argc, argv);
  static const auto matte = loadGroup(file);
  static const auto glossy = loadGroup(
      file,
      [](Scene& scene) { scene.materials.at(0).metallic = 1.0f, scene.materials.at(0).roughness = 0.5f; }, {},
      /*with_glossy=*/true);
  DecodedImages images(glossy->scene);
  static const SurfaceBrdfs brdfs = orExit(SurfaceBrdfs::load(
      glossy->scene, glossy->geometry, orExit(BrdfTables::make(glossy->scene, 5, 5)), images, 5));
  static const ExitKernels kernels{
      brdfs.grey(), [](std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out) {
        brdfs.exitKernel(triangle, u, v, to, out);
      }};
  for (const bool hits : {false, true})
    benchmark::RegisterBenchmark(
        hits ? "glossy/with_hits_and_a_bounce" : "glossy/direct",
        [hits](benchmark::State& state) {
          Timed plain, other;
          for (auto _ : state)
            withThreads(1, [&] { plain = run(*matte, kernels, hits), other = run(*glossy, kernels, hits); });
          state.counters["diffuse_Mrays/s"] = 1e-6 * plain.perSecond();
          state.counters["glossy_Mrays/s"] = 1e-6 * other.perSecond();
          state.counters["ratio"] = other.perSecond() / plain.perSecond();
          state.counters["diffuse_bounce_s"] = plain.bounce_seconds;
          state.counters["glossy_bounce_s"] = other.bounce_seconds;
        })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
