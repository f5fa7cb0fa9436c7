// Measures what glossy transfer costs in storage: bytes per vertex of visibility and bounced light together,
// after entropy coding, against the error of reflected light.
//   bench_glossy_codes SCENE [--rays=N] [--bounces=N] [--bounds=3,1.5,1,0.5]
// Rows are error bounds, for which clusters and axes are chosen as in a bake. The goal is under 40 bytes per
// vertex at 1.5 %.
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/cell_vectors.hpp"
#include "baker/effects/surface/direct.hpp"
#include "bench/coded_bytes.hpp"
#include "bench/group_workload.hpp"

namespace {

using namespace lambent;
using namespace lambent::baker;

constexpr int kOrder = 5;

struct Options {
  std::string scene;
  std::vector<float> bounds_percent = {3.0f, 1.5f, 1.0f, 0.5f};
  std::size_t rays = 1024;
  int bounces = 3;
};

DirectResult transport(const GroupWorkload& work, const SurfaceBrdfs& brdfs, const Options& options) {
  Progress progress;
  const DirectPass pass(work.view(), {.order = kOrder,
                                      .rays = options.rays,
                                      .keep_hits = options.bounces > 0,
                                      .hit_memory = std::size_t{1} << 30,
                                      .colored_kernels = !brdfs.grey(),
                                      .order_out = kOrder});
  auto direct = bakeDirect(pass, {progress});
  if (options.bounces > 0) {
    const ExitKernels kernels{.grey = brdfs.grey(),
                              .at = [&](std::uint32_t triangle, float u, float v, const glm::vec3& to,
                                        std::span<float> out) { brdfs.exitKernel(triangle, u, v, to, out); }};
    bakeBounces({.pass = pass, .direct = *direct, .kernels = &kernels}, {options.bounces, 1e-3, kOrder},
                {progress});
  }
  return std::move(*direct);
}

// Holds visibility and bounced light of all cells, and the error of both together; each gets the same share
// of the bound.
struct Measured {
  std::array<CodedBytes, 2> parts;
  double error = 0.0;
};

Measured measure(const std::vector<std::vector<CellVectors>>& cells, CodingSettings settings) {
  Measured out;
  for (const auto& parts : cells) {
    settings.shown_energy = 0.0;
    for (const CellVectors& part : parts)
      settings.shown_energy += transferEnergy(part.vectors, part.shape, settings.kernel_power);
    CodingSettings own = settings;
    own.bound /= std::sqrt(static_cast<float>(parts.size()));
    double square = 0.0;
    for (const CellVectors& part : parts)
      square += std::pow(out.parts[part.shape.isVisibility() ? 0 : 1].add(part, own), 2.0);
    out.error = std::max(out.error, std::sqrt(square));
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Measures what glossy transfer costs in storage.");
  app.add_option("SCENE", options.scene)->required();
  app.add_option("--rays", options.rays);
  app.add_option("--bounces", options.bounces);
  app.add_option("--bounds", options.bounds_percent)->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  const auto work = loadGroup(options.scene, {}, {}, /*with_glossy=*/true);
  if (work->samples.glossy.empty()) {
    std::fprintf(stderr, "%s: has no glossy material; see bench/with_material.py\n", options.scene.c_str());
    return 1;
  }
  const BrdfTables tables = orExit(BrdfTables::make(work->scene, kOrder, kOrder));
  DecodedImages images(work->scene);
  const SurfaceBrdfs brdfs = orExit(SurfaceBrdfs::load(work->scene, work->geometry, tables, images, kOrder));
  const DirectResult direct = transport(*work, brdfs, options);
  std::vector<std::vector<CellVectors>> cells;
  for (const SampleCell& cell : work->samples.cells) {
    if (cell.kind != SampleKind::Glossy) continue;
    cells.push_back(cellVectors(cell, work->samples, direct, nullptr,
                                {.sky = true, .lights = work->colors->greyEmission()}));
    std::erase_if(cells.back(), [](const CellVectors& part) { return part.shape.order == 0; });
  }

  const auto vertices = static_cast<double>(work->geometry.positions.size());
  std::printf(
      "%s: %.0f vertices, %zu glossy samples; zstd %d; visibility | bounced light\n"
      "bytes/vertex    error | clusters  axes   bytes = book +  ids + weights   error  seconds\n",
      options.scene.c_str(), vertices, direct.glossy.size(), kZstdLevel);
  for (const float percent : options.bounds_percent) {
    const Measured m = measure(
        cells, {.bound = percent / 100.0f, .kernel_power = kernelPower(work->geometry, brdfs, kOrder)});
    const auto each = [&](std::size_t bytes) { return static_cast<double>(bytes) / vertices; };
    std::printf("%12.2f  %6.3f %%", each(m.parts[0].bytes() + m.parts[1].bytes()), 100.0 * m.error);
    for (const CodedBytes& part : m.parts)
      std::printf(" | %8zu %5.1f  %6.2f = %5.2f + %4.2f + %6.2f  %6.3f %% %5.1f", part.clusters,
                  static_cast<double>(part.codes) / static_cast<double>(direct.glossy.size()),
                  each(part.bytes()), each(part.codebook), each(part.ids), each(part.weights),
                  100.0 * part.error, part.seconds);
    std::printf("\n");
    std::fflush(stdout);
  }
  return 0;
}
