// Measures what accuracy costs at glossy samples: the error of visibility and of bounced light (RMS over real
// lights, relative to both together) against the number of rays, beside the seconds of both. The truth is the
// same bake with many rays.
//   glossy_ray_error SCENE.glb [--truth=RAYS] [--bounces=N] [--rays=N,N,...]
// --bounces=-1 takes as many passes as needed.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/effects/glossy/glossy_bounces.hpp"
#include "bench/group_workload.hpp"

namespace {

using namespace lambent;
using namespace lambent::baker;

constexpr int kOrder = 5;

struct Baked {
  GlossyField field;
  std::size_t passes = 0;
  double direct_seconds = 0.0, bounce_seconds = 0.0;
};

Baked bakeWith(const GroupWorkload& work, const ExitKernels& kernels, std::size_t rays, int bounces) {
  using Clock = std::chrono::steady_clock;
  const auto secondsSince = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const TracedScene view = work.view();
  const DirectPass plain(view, {.order = kOrder,
                                .rays = rays,
                                .keep_hits = bounces != 0,
                                .hit_memory = std::size_t{8} << 30,
                                .colored_kernels = !kernels.grey});
  const GlossyPass glossy(plain, view, kOrder);
  Progress progress;
  Baked baked;
  auto start = Clock::now();
  auto direct = bakeDirect(plain, view, {progress});
  auto seen = bakeGlossyDirect(glossy, std::size_t{8} << 30, direct->looks, {progress});
  diffuseFromGlossy(glossy, seen->field, *direct, {});
  baked.direct_seconds = secondsSince(start);
  start = Clock::now();
  GlossyBounces partner(glossy, kernels, *direct, *seen, kOrder);
  const auto bounced = bakeBounces(plain, *direct, view, {.bounces = bounces}, {progress}, &partner);
  partner.finish();
  baked.bounce_seconds = secondsSince(start);
  baked.passes = bounced->energy.size() - 1;
  baked.field = std::move(seen->field);
  return baked;
}

std::vector<float> differences(const std::vector<float>& a, const std::vector<float>& b) {
  std::vector<float> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t truth_rays = 8192;
  int bounces = 1;
  std::vector<std::size_t> counts = {256, 512, 1024, 2048};
  if (argc < 2) {
    std::fprintf(stderr, "glossy_ray_error: no scene; give a .gltf or .glb file with a glossy material\n");
    return 2;
  }
  for (int i = 2; i < argc; ++i) {
    if (std::strncmp(argv[i], "--truth=", 8) == 0) truth_rays = std::strtoul(argv[i] + 8, nullptr, 10);
    if (std::strncmp(argv[i], "--bounces=", 10) == 0) bounces = std::atoi(argv[i] + 10);
    if (std::strncmp(argv[i], "--rays=", 7) == 0) {
      counts.clear();
      for (char* at = argv[i] + 7; *at != '\0'; at += *at == ',') counts.push_back(std::strtoul(at, &at, 10));
    }
  }
  const auto work = loadGroup(argv[1], {}, {}, /*with_glossy=*/true);
  if (work->samples.glossy.empty()) {
    std::fprintf(stderr, "%s: has no glossy material; see bench/with_material.py\n", argv[1]);
    return 1;
  }
  const BrdfTables tables = orExit(BrdfTables::make(work->scene, kOrder, kOrder));
  DecodedImages images(work->scene);
  const SurfaceBrdfs brdfs = orExit(SurfaceBrdfs::load(work->scene, work->geometry, tables, images, kOrder));
  const ExitKernels kernels{
      brdfs.grey(), [&](std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out) {
        brdfs.exitKernel(triangle, u, v, to, out);
      }};

  const Baked truth = bakeWith(*work, kernels, truth_rays, bounces);
  const transfer::TransferShape visibility{
      .order = kOrder, .outputs = kOrder * kOrder, .visibility_bands = 2 * kOrder - 1};
  const transfer::TransferShape bounced{.order = kOrder,
                                        .shadowed_channels = 0,
                                        .full_channels = truth.field.channels,
                                        .outputs = kOrder * kOrder};
  // Each energy is that of one set of outputs; their sum is all light, as bakes weight it.
  const double of_bounced = transferEnergy(truth.field.bounced, bounced),
               all = transferEnergy(truth.field.visibility, visibility) + of_bounced;
  std::printf(
      "%s: %zu glossy samples, order %d, %zu passes (%.1f s direct, %.1f s bounces) against %zu rays;\n"
      "bounced light is %.1f %% of all\n"
      "  rays  visibility   bounced   direct s  bounces s\n",
      argv[1], truth.field.size(), kOrder, truth.passes, truth.direct_seconds, truth.bounce_seconds,
      truth_rays, 100.0 * std::sqrt(of_bounced / all));
  for (const std::size_t count : counts) {
    const Baked test = bakeWith(*work, kernels, count, bounces);
    const auto error = [&](const std::vector<float>& a, const std::vector<float>& b,
                           const transfer::TransferShape& shape) {
      return 100.0 * std::sqrt(transferEnergy(differences(a, b), shape) / all);
    };
    std::printf("%6zu    %6.3f %%  %6.3f %%  %9.2f  %9.2f\n", count,
                error(truth.field.visibility, test.field.visibility, visibility),
                error(truth.field.bounced, test.field.bounced, bounced), test.direct_seconds,
                test.bounce_seconds);
    std::fflush(stdout);
  }
  return 0;
}
