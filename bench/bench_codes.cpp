// Measures what accuracy costs in storage: bytes per vertex of the coded transfer, after entropy coding,
// against the error bound. Clusters are those that codeTransfer chooses, beside one cluster (plain principal
// components).
//   bench_codes SCENE [--bounds=1,0.5,0.3,0.1] [--order=N] [--rays=N] [--bounces=N] [--albedo=R,G,B]
//               [--normal-mapped] [--clusters=N] [--csv]
// --albedo is used for all surfaces in place of their materials'; --normal-mapped bakes transfer for normal
// maps everywhere; --clusters sets the number of clusters in place of the best. The goal is under 16 bytes
// per vertex at 0.5 %, with order 5, RGB and bounces.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/cell_vectors.hpp"
#include "bench/coded_bytes.hpp"
#include "bench/group_workload.hpp"

namespace {

using namespace lambent;
using namespace lambent::baker;

struct Options {
  const char* scene = nullptr;
  std::vector<double> bounds = {0.01, 0.005, 0.003, 0.001};
  std::vector<double> albedo;
  int order = 5, bounces = -1;
  std::size_t rays = 512;
  std::uint32_t clusters = 0;
  bool normal_mapped = false, csv = false;
};

std::vector<double> numbers(std::string_view list) {
  std::vector<double> out;
  for (std::string text(list); !text.empty();) {
    char* end = nullptr;
    out.push_back(std::strtod(text.c_str(), &end));
    text = *end == ',' ? end + 1 : "";
  }
  return out;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const std::string_view value = argument.substr(std::min(argument.size(), argument.find('=') + 1));
    const auto is = [&](std::string_view name) { return argument.substr(0, argument.find('=')) == name; };
    if (is("--bounds")) {
      options.bounds = numbers(value);
      for (double& bound : options.bounds) bound /= 100.0;
    } else if (is("--albedo")) {
      options.albedo = numbers(value);
    } else if (is("--order")) {
      options.order = static_cast<int>(numbers(value).at(0));
    } else if (is("--rays")) {
      options.rays = static_cast<std::size_t>(numbers(value).at(0));
    } else if (is("--bounces")) {
      options.bounces = static_cast<int>(numbers(value).at(0));
    } else if (is("--clusters")) {
      options.clusters = static_cast<std::uint32_t>(numbers(value).at(0));
    } else if (is("--normal-mapped")) {
      options.normal_mapped = true;
    } else if (is("--csv")) {
      options.csv = true;
    } else {
      options.scene = argv[i];
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  if (options.scene == nullptr || (!options.albedo.empty() && options.albedo.size() != 3)) {
    std::fprintf(stderr, "bench_codes: give a .gltf or .glb file, and three numbers to --albedo\n");
    return 2;
  }
  const auto paint = [&](Scene& scene) {
    if (options.albedo.empty()) return;
    for (auto& material : scene.materials) {
      material.base_color =
          glm::vec4(static_cast<float>(options.albedo[0]), static_cast<float>(options.albedo[1]),
                    static_cast<float>(options.albedo[2]), material.base_color.a);
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
        options.scene, vertices, samples.size(), cells.at(0).shape.size(), cells.size(), kZstdLevel);
  for (const double bound : options.bounds)
    for (const std::uint32_t clusters : {1u, options.clusters}) {
      CodedBytes row;
      for (const CellVectors& cell : cells)
        row.add(cell, {.bound = static_cast<float>(bound), .clusters = clusters});
      const double axes = static_cast<double>(row.codes) / static_cast<double>(samples.size());
      const auto each = [&](std::size_t bytes) { return static_cast<double>(bytes) / vertices; };
      if (options.csv)
        std::printf("%s,%.0f,%zu,%u,%g,%zu,%.2f,%.3f,%.3f,%.3f,%.3f,%.6f,%.3f\n", options.scene, vertices,
                    samples.size(), cells.at(0).shape.size(), bound, row.clusters, axes, each(row.bytes()),
                    each(row.codebook), each(row.ids), each(row.weights), row.error, row.seconds);
      else
        std::printf("%5.2f %%  %8zu  %5.1f  %12.2f   %8.2f  %5.2f  %8.2f  %6.3f %%  %7.2f\n", 100.0 * bound,
                    row.clusters, axes, each(row.bytes()), each(row.codebook), each(row.ids),
                    each(row.weights), 100.0 * row.error, row.seconds);
      std::fflush(stdout);
    }
  return 0;
}
