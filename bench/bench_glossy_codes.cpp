// What glossy transfer costs in storage: bytes per vertex of visibility and bounced light together, after
// entropy coding, against the error of reflected light.
//   bench_glossy_codes SCENE [--rays=N] [--bounces=N] [--bounds=3,1.5,1,0.5] [--grid] [--csv]
// By bounds as a bake does it (clusters and axes that cost least), or with --grid for so many clusters, 1 to
// 512, with so many axes each, 0 (vector quantization) to 16. Goal: under 40 bytes a vertex at 1.5 %.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/effects/glossy/glossy_bounces.hpp"
#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/effects/glossy/payloads.hpp"
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
  bool grid = false, csv = false;
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
    } else if (argument == "--grid") {
      options.grid = true;
    } else if (argument == "--csv") {
      options.csv = true;
    } else {
      options.scene = argv[i];
    }
  }
  return options;
}

GlossyField transport(const GroupWorkload& work, const SurfaceBrdfs& brdfs, const Options& options) {
  const DiffuseScene view = work.view();
  Progress progress;
  const DirectPass plain(view, {.order = kOrder,
                                .rays = options.rays,
                                .keep_hits = options.bounces > 0,
                                .hit_memory = std::size_t{1} << 30,
                                .colored_kernels = !brdfs.grey()});
  auto direct = bakeDirect(plain, view, progress, {});
  const GlossyPass pass(plain, view, kOrder);
  auto glossy = bakeGlossyDirect(pass, std::size_t{1} << 30, *direct, progress, {});
  if (options.bounces > 0) {
    const ExitKernels kernels{.grey = brdfs.grey(),
                              .at = [&](std::uint32_t triangle, float u, float v, const glm::vec3& to,
                                        std::span<float> out) { brdfs.exitKernel(triangle, u, v, to, out); }};
    GlossyBounces bounces(pass, kernels, *direct, *glossy);
    bakeBounces(plain, *direct, view, {options.bounces, 1e-3}, progress, {}, &bounces);
    bounces.finish();
  }
  return std::move(glossy->field);
}

// All cells, visibility and bounced light with as much error each.
struct Measured {
  CodedBytes bytes;
  double error = 0.0;
};

Measured measure(const std::vector<std::vector<CellVectors>>& cells, CodingSettings settings) {
  Measured out;
  for (const auto& parts : cells) {
    double shown = 0.0, square = 0.0;
    for (const CellVectors& part : parts) shown += transferEnergy(part.vectors, part.shape);
    settings.shown_energy = shown;
    CodingSettings own = settings;
    own.bound /= std::sqrt(static_cast<float>(parts.size()));
    for (const CellVectors& part : parts) {
      CodedBytes coded;
      coded.add(part, own);
      square += coded.error * coded.error;
      out.bytes.clusters += coded.clusters, out.bytes.codebook += coded.codebook, out.bytes.ids += coded.ids;
      out.bytes.weights += coded.weights, out.bytes.codes += coded.codes, out.bytes.seconds += coded.seconds;
    }
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
  if (work->samples.first_glossy == work->samples.size()) {
    std::fprintf(stderr, "%s: has no glossy material; see bench/with_material.py\n", options.scene);
    return 1;
  }
  const BrdfTables tables = orExit(BrdfTables::make(work->scene, kOrder));
  DecodedImages images(work->scene);
  const SurfaceBrdfs brdfs = orExit(SurfaceBrdfs::load(work->scene, work->geometry, tables, images, kOrder));
  const GlossyField field = transport(*work, brdfs, options);
  std::vector<std::vector<CellVectors>> cells;
  for (const SampleCell& cell : work->samples.cells) {
    if (cell.kind != SampleKind::Glossy) continue;
    cells.push_back(glossyCellVectors(cell, field, work->colors->greyEmission()));
    std::erase_if(cells.back(), [](const CellVectors& part) { return part.shape.order == 0; });
  }

  const auto vertices = static_cast<double>(work->geometry.positions.size());
  if (options.csv)
    std::printf(
        "scene,clusters_asked,axes_asked,bound,clusters,bytes_per_vertex,codebook,ids,weights,error,"
        "seconds\n");
  else
    std::printf(
        "%s: %.0f vertices, %zu glossy samples; zstd %d\n"
        "clusters  axes  bytes/vertex = codebook +  ids + weights     error  seconds\n",
        options.scene, vertices, field.size(), kZstdLevel);
  const auto row = [&](const CodingSettings& settings) {
    const Measured m = measure(cells, settings);
    const auto each = [&](std::size_t bytes) { return static_cast<double>(bytes) / vertices; };
    if (options.csv)
      std::printf("%s,%u,%d,%g,%zu,%.3f,%.3f,%.3f,%.3f,%.6f,%.2f\n", options.scene, settings.clusters,
                  settings.axes, double{settings.bound}, m.bytes.clusters, each(m.bytes.bytes()),
                  each(m.bytes.codebook), each(m.bytes.ids), each(m.bytes.weights), m.error, m.bytes.seconds);
    else
      std::printf("%8zu  %4.1f  %12.2f   %8.2f  %5.2f  %8.2f  %6.3f %%  %7.2f\n", m.bytes.clusters,
                  static_cast<double>(m.bytes.codes) / static_cast<double>(field.size()),
                  each(m.bytes.bytes()), each(m.bytes.codebook), each(m.bytes.ids), each(m.bytes.weights),
                  100.0 * m.error, m.bytes.seconds);
    std::fflush(stdout);
  };
  if (options.grid) {
    // Fine steps: what is left is what the axes leave out.
    for (const std::uint32_t clusters : {1u, 4u, 16u, 64u, 256u, 512u})
      for (const int axes : {0, 1, 2, 4, 8, 16}) row({.bound = 0.005f, .clusters = clusters, .axes = axes});
  } else {
    for (const double bound : options.bounds) row({.bound = static_cast<float>(bound)});
  }
  return 0;
}
