// Measures what accuracy costs in storage: bytes per vertex of the coded transfer, after entropy coding,
// against the error bound. Clusters are those that codeTransfer chooses, beside one cluster (plain principal
// components).
//   bench_codes SCENE [--bounds=1,0.5,0.3,0.1] [--order=N] [--rays=N] [--bounces=N] [--albedo=R,G,B]
//               [--normal-mapped] [--clusters=N] [--csv]
// --albedo is used for all surfaces in place of their materials'; --normal-mapped bakes transfer for normal
// maps everywhere; --clusters sets the number of clusters in place of the best. The goal is under 16 bytes
// per vertex at 0.5 %, with order 5, RGB and bounces.
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/cell_vectors.hpp"
#include "bench/coded_bytes.hpp"
#include "bench/group_workload.hpp"

namespace {

using namespace lambent;
using namespace lambent::baker;

struct Options {
  std::string scene;
  std::vector<double> bounds_percent = {1.0, 0.5, 0.3, 0.1};
  std::vector<float> albedo;
  int order = 5, bounces = -1;
  std::size_t rays = 512;
  std::uint32_t clusters = 0;
  bool normal_mapped = false, csv = false;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Measures what accuracy costs in storage.");
  app.add_option("SCENE", options.scene)->required();
  app.add_option("--bounds", options.bounds_percent)->delimiter(',');
  app.add_option("--albedo", options.albedo)->delimiter(',')->expected(3);
  app.add_option("--order", options.order);
  app.add_option("--rays", options.rays);
  app.add_option("--bounces", options.bounces);
  app.add_option("--clusters", options.clusters);
  app.add_flag("--normal-mapped", options.normal_mapped);
  app.add_flag("--csv", options.csv);
  CLI11_PARSE(app, argc, argv);
  const auto paint = [&](Scene& scene) {
    if (options.albedo.empty()) return;
    for (auto& material : scene.materials) {
      material.base_color = {options.albedo[0], options.albedo[1], options.albedo[2], material.base_color.a};
      material.base_color_texture = {};
    }
  };
  const auto map = [&](GroupGeometry& geometry) {
    if (!options.normal_mapped) return;
    for (DrawGeometry& draw : geometry.draws) draw.kind = SampleKind::NormalMapped;
  };
  const auto work = loadGroup(options.scene, paint, map);
  const SampleSet& samples = work->samples;
  Progress progress;
  const DirectPass pass(work->view(), {.order = options.order,
                                       .rays = options.rays,
                                       .keep_hits = options.bounces != 0,
                                       .hit_memory = std::size_t{2} << 30});
  auto direct = bakeDirect(pass, {progress});
  std::optional<BounceResult> bounced;
  if (options.bounces != 0) bounced = bakeBounces({pass, *direct}, {options.bounces, 1e-3}, {progress});
  std::vector<CellVectors> cells;
  for (const SampleCell& cell : samples.cells)
    for (CellVectors& parts : cellVectors(cell, samples, *direct, bounced ? &*bounced : nullptr,
                                          {.sky = true, .lights = work->colors->greyEmission()}))
      cells.push_back(std::move(parts));

  const auto vertices = static_cast<double>(work->geometry.positions.size());
  if (options.csv)
    std::printf(
        "scene,vertices,samples,values,bound,clusters,axes,bytes_per_vertex,codebook,ids,weights,"
        "error,seconds\n");
  else
    std::printf(
        "%s: %.0f vertices, %zu samples of %u values in %zu cells; zstd %d\n"
        " bound  clusters   axes  bytes/vertex = codebook +  ids + weights     error  seconds\n",
        options.scene.c_str(), vertices, samples.size(), cells.at(0).shape.size(), cells.size(), kZstdLevel);
  for (const double percent : options.bounds_percent)
    for (const std::uint32_t clusters : {1u, options.clusters}) {
      CodedBytes row;
      for (const CellVectors& cell : cells)
        row.add(cell, {.bound = static_cast<float>(percent / 100.0), .clusters = clusters});
      const double axes = static_cast<double>(row.codes) / static_cast<double>(samples.size());
      const auto each = [&](std::size_t bytes) { return static_cast<double>(bytes) / vertices; };
      if (options.csv)
        std::printf("%s,%.0f,%zu,%u,%g,%zu,%.2f,%.3f,%.3f,%.3f,%.3f,%.6f,%.3f\n", options.scene.c_str(),
                    vertices, samples.size(), cells.at(0).shape.size(), percent / 100.0, row.clusters, axes,
                    each(row.bytes()), each(row.codebook), each(row.ids), each(row.weights), row.error,
                    row.seconds);
      else
        std::printf("%5.2f %%  %8zu  %5.1f  %12.2f   %8.2f  %5.2f  %8.2f  %6.3f %%  %7.2f\n", percent,
                    row.clusters, axes, each(row.bytes()), each(row.codebook), each(row.ids),
                    each(row.weights), 100.0 * row.error, row.seconds);
      std::fflush(stdout);
    }
  return 0;
}
