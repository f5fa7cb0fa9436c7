// Measures neighborhood transfer of a ball of 5 k triangles over a floor: time and bytes of a grid, and the
// error of interpolation in the coded grid at random points outside the ball. The truth is a closed form for
// a black ball, and many rays for a white one.
//   bench_neighborhood [--around] [--white] [--matrices] [--rays N]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

#include "baker/effects/neighborhood/bodies.hpp"
#include "baker/effects/neighborhood/neighborhood.hpp"
#include "bench/coded_bytes.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/support/neighborhood.hpp"

namespace {

using namespace lambent;
using namespace lambent::baker;

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::size_t packedBytes(const BakedNeighborhood& grid) {
  const auto packed = [](const std::vector<std::byte>& raw) {
    return std::min(raw.size(), bundle::compressZstd(raw, kZstdLevel).size());
  };
  std::size_t bytes = 0;
  for (const CodedCell& cell : grid.cells)
    for (const CodedTransfer& coded : cell.transfers) {
      const auto clusters = static_cast<std::uint32_t>(coded.codebook.clusters());
      bytes += packed(transfer::encodeCodebook(coded.codebook));
      if (clusters > 1) bytes += packed(transfer::encodeClusterIds(coded.cluster_of, clusters));
      for (const CodedPlane& plane : coded.planes)
        bytes += packed(transfer::encodeWeightPlane(plane.codes, plane.bits));
    }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  bool around = false, white = false, matrices = false;
  std::size_t rays = 2048;
  for (int i = 1; i < argc; ++i) {
    around = around || std::strcmp(argv[i], "--around") == 0;
    white = white || std::strcmp(argv[i], "--white") == 0;
    matrices = matrices || std::strcmp(argv[i], "--matrices") == 0;
    if (std::strcmp(argv[i], "--rays") == 0 && i + 1 < argc)
      rays = static_cast<std::size_t>(std::atoi(argv[++i]));
  }
  Scene scene = lambent::testing::sceneOf({lambent::testing::icosphere({0, 0, 0}, 1.0f, 4)});
  if (!white) scene.materials[0].base_color = {0, 0, 0, 1};
  const lambent::testing::Transport transport(scene);
  const auto baked = transport.bake(5, 512, white ? -1 : 0);
  const SurfaceBody body(transport.diffuse(), {baked.direct.field, white ? &baked.bounced.field : nullptr,
                                               white, nullptr, nullptr});
  // The first "change %" is the coding error relative to the change that 99 of 100 points stay under; the
  // last column is the whole error relative to the change.
  std::printf("%-10s %8s %8s %9s %8s %8s %8s %8s %8s\n", "grid", "s", "kB", "coding %", "change %", "RMS %",
              "p99 %", "near %", "change %");
  const std::vector<glm::uvec3> sizes =
      around ? std::vector<glm::uvec3>{{8, 8, 8}, {16, 16, 16}, {24, 24, 24}, {32, 32, 32}}
             : std::vector<glm::uvec3>{{16, 16, 4}, {32, 32, 4}, {32, 32, 8}, {64, 64, 8}};
  for (const glm::uvec3 size : sizes) {
    NeighborhoodSettings settings;
    settings.rays = rays;
    settings.matrices = matrices;
    settings.placement.body = {transport.geometry.bounds_min, transport.geometry.bounds_max};
    // This is a floor over which the ball flies, 0.2 to 2 radii below it.
    if (!around) settings.placement.receivers = Box3{{-20.0f, -3.0f, -20.0f}, {20.0f, -1.2f, 20.0f}};
    settings.placement.by_length = size;
    Progress progress;
    const auto start = std::chrono::steady_clock::now();
    const auto result = bakeNeighborhood(body, settings, {progress});
    progress.end();
    const double seconds = secondsSince(start);
    const lambent::testing::DecodedNeighborhood decoded(*result->grid);
    // The black ball has a closed form; the white one is traced with many rays from the same points.
    const CapDirections many(16 * rays);
    PointChange traced(body, many, decoded.shape());
    const lambent::testing::NeighborhoodErrors errors = lambent::testing::errorsAgainst(
        decoded, settings.placement.receivers, white ? 500 : 4000, [&](const glm::vec3& p) {
          if (!white) return lambent::testing::blackSphereChange(p, 1.0f, 5, decoded.shape().order_out);
          traced.look(p);
          return lambent::testing::matrixOf(decoded.shape(), traced.visibility(), traced.bounced());
        });
    std::printf("%ux%ux%-4u %8.2f %8.1f %9.3f %8.2f %8.3f %8.3f %8.3f %8.2f\n", result->figures.size.x,
                result->figures.size.y, result->figures.size.z, seconds,
                static_cast<double>(packedBytes(*result->grid)) / 1e3, 100.0 * result->figures.error,
                100.0 * result->figures.change_error, 100.0 * errors.rms, 100.0 * errors.p99,
                100.0 * errors.near_rms, 100.0 * errors.of_change);
    std::printf("           box %.2f %.2f %.2f to %.2f %.2f %.2f, %zu inside\n",
                double{result->figures.bounds_min.x}, double{result->figures.bounds_min.y},
                double{result->figures.bounds_min.z}, double{result->figures.bounds_max.x},
                double{result->figures.bounds_max.y}, double{result->figures.bounds_max.z},
                result->figures.inside_points);
  }
  return 0;
}
