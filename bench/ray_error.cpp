// Measures what accuracy costs at the samples: the error (relative RMS of shaded radiance over real lights)
// against the number of rays, beside the time, for direct light alone and for all light. The truth is the
// same bake with many rays.
//   ray_error SCENE.glb [--truth=RAYS] [--bounces=N]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/cell_vectors.hpp"
#include "bench/group_workload.hpp"

namespace {

using namespace lambent::baker;
constexpr int kOrder = 5;

struct Baked {
  DirectResult direct;
  std::optional<BounceResult> bounced;
  double seconds = 0.0;
};

Baked bakeWith(const GroupWorkload& work, std::size_t rays, int bounces) {
  const auto start = std::chrono::steady_clock::now();
  const DirectPass pass(
      work.view(),
      {.order = kOrder, .rays = rays, .keep_hits = bounces > 0, .hit_memory = std::size_t{4} << 30});
  Progress progress;
  Baked baked{*bakeDirect(pass, {progress}), {}, 0.0};
  if (bounces > 0) baked.bounced = bakeBounces({pass, baked.direct}, {bounces, 0.0}, {progress});
  baked.direct.parts = {};
  baked.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return baked;
}

// Returns only the last block of the vectors: all light if there are bounces, else direct light.
CellVectors shownBlock(const CellVectors& from) {
  if (from.shape.full_channels == 0) return from;
  CellVectors out{from.shape, {}};
  out.shape.shadowed_channels = from.shape.full_channels;
  out.shape.full_channels = 0;
  const std::size_t skip = from.shape.size() - out.shape.size();
  for (std::size_t at = 0; at < from.vectors.size(); at += from.shape.size())
    out.vectors.insert(out.vectors.end(), from.vectors.begin() + static_cast<std::ptrdiff_t>(at + skip),
                       from.vectors.begin() + static_cast<std::ptrdiff_t>(at + from.shape.size()));
  return out;
}

// Returns the error over all cells, of light from the environment.
double errorOf(const GroupWorkload& work, const Baked& truth, const Baked& test, bool all_light) {
  double error = 0.0, samples = 0.0;
  for (const SampleCell& cell : work.samples.cells) {
    const auto vectorsOf = [&](const Baked& baked) {
      return cellVectors(cell, work.samples, baked.direct,
                         all_light && baked.bounced ? &*baked.bounced : nullptr,
                         {.sky = true, .lights = true})[0];
    };
    const CellVectors a = shownBlock(vectorsOf(truth)), b = shownBlock(vectorsOf(test));
    if (a.shape != b.shape) continue;
    const double cell_error = radianceError(a.vectors, b.vectors, a.shape);
    error += cell.count * cell_error * cell_error;
    samples += cell.count;
  }
  return std::sqrt(error / samples);
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t truth_rays = 16384;
  int bounces = 3;
  if (argc < 2) {
    std::fprintf(stderr, "ray_error: no scene; give a .gltf or .glb file\n");
    return 2;
  }
  for (int i = 2; i < argc; ++i) {
    if (std::strncmp(argv[i], "--truth=", 8) == 0) truth_rays = std::strtoul(argv[i] + 8, nullptr, 10);
    if (std::strncmp(argv[i], "--bounces=", 10) == 0) bounces = std::atoi(argv[i] + 10);
  }
  const auto work = loadGroup(argv[1]);
  const Baked truth = bakeWith(*work, truth_rays, bounces);
  std::printf(
      "%s: %zu samples, order %d, %d bounces, against %zu rays\n  rays   direct  all light   seconds\n",
      argv[1], work->samples.size(), kOrder, bounces, truth_rays);
  for (const std::size_t count : {128u, 256u, 512u, 1024u, 2048u, 4096u}) {
    const Baked test = bakeWith(*work, count, bounces);
    std::printf("%6zu  %5.2f %%    %5.2f %%   %7.2f\n", count, 100.0 * errorOf(*work, truth, test, false),
                100.0 * errorOf(*work, truth, test, true), test.seconds);
  }
  return 0;
}
