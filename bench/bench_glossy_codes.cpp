// Measures what glossy transfer costs in storage: bytes per vertex of visibility and bounced light together,
// after entropy coding, against the error of reflected light.
//   bench_glossy_codes SCENE [--rays=N] [--bounces=N] [--bounds=3,1.5,1,0.5] [--csv]
// Rows are error bounds, for which clusters and axes are chosen as in a bake. The goal is under 40 bytes per
// vertex at 1.5 %.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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
  const char* scene = nullptr;
  std::vector<double> bounds = {0.03, 0.015, 0.01, 0.005};
  std::size_t rays = 1024;
  int bounces = 3;
  bool csv = false;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const auto value = [&] { return argv[i] + argument.find('=') + 1; };
    if (argument.starts_with("--rays=")) {
      options.rays = static_cast<std::size_t>(std::atoll(value()));
    } else if (argument.starts_with("--bounces=")) {
      options.bounces = std::atoi(value());
    } else if (argument.starts_with("--bounds=")) {
      options.bounds.clear();
      for (const char* at = value(); *at != 0;) {
        char* end = nullptr;
        options.bounds.push_back(std::strtod(at, &end) / 100.0);
        at = *end == ',' ? end + 1 : "";
      }
    } else if (argument == "--csv") {
      options.csv = true;
    } else {
      options.scene = argv[i];
    }
  }
  return options;
}

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
  const Options options = parse(argc, argv);
  if (options.scene == nullptr) {
    std::fprintf(stderr, "bench_glossy_codes: give a .gltf or .glb file with a glossy material\n");
    return 2;
  }
  const auto work = loadGroup(options.scene, {}, {}, /*with_glossy=*/true);
  if (work->samples.glossy.empty()) {
    std::fprintf(stderr, "%s: has no glossy material; see bench/with_material.py\n", options.scene);
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
  if (options.csv)
    std::printf(
        "scene,bound,bytes_per_vertex,error,part,clusters,axes,bytes,"
        "codebook,ids,weights,part_error,seconds\n");
  else
    std::printf(
        "%s: %.0f vertices, %zu glossy samples; zstd %d; visibility | bounced light\n"
        "bytes/vertex    error | clusters  axes   bytes = book +  ids + weights   error  seconds\n",
        options.scene, vertices, direct.glossy.size(), kZstdLevel);
  const auto row = [&](CodingSettings settings) {
    settings.kernel_power = kernelPower(work->geometry, brdfs, kOrder);
    const Measured m = measure(cells, settings);
    const auto each = [&](std::size_t bytes) { return static_cast<double>(bytes) / vertices; };
    const double all = each(m.parts[0].bytes() + m.parts[1].bytes());
    if (!options.csv) std::printf("%12.2f  %6.3f %%", all, 100.0 * m.error);
    for (std::size_t p = 0; p < 2; ++p) {
      const CodedBytes& part = m.parts[p];
      const double axes = static_cast<double>(part.codes) / static_cast<double>(direct.glossy.size());
      if (options.csv)
        std::printf("%s,%g,%.3f,%.6f,%s,%zu,%.2f,%.3f,%.3f,%.3f,%.3f,%.6f,%.2f\n", options.scene,
                    double{settings.bound}, all, m.error, p == 0 ? "visibility" : "bounced", part.clusters,
                    axes, each(part.bytes()), each(part.codebook), each(part.ids), each(part.weights),
                    part.error, part.seconds);
      else
        std::printf(" | %8zu %5.1f  %6.2f = %5.2f + %4.2f + %6.2f  %6.3f %% %5.1f", part.clusters, axes,
                    each(part.bytes()), each(part.codebook), each(part.ids), each(part.weights),
                    100.0 * part.error, part.seconds);
    }
    if (!options.csv) std::printf("\n");
    std::fflush(stdout);
  };
  for (const double bound : options.bounds) row({.bound = static_cast<float>(bound)});
  return 0;
}
