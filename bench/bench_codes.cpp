// Measures what accuracy costs in storage: bytes per vertex of the coded transfer, after entropy coding,
// against the error bound. Clusters are those that codeTransfer chooses, beside one cluster (plain principal
// components).
//   bench_codes SCENE [--bounds=1,0.5,0.3,0.1] [--order=N] [--rays=N] [--bounces=N] [--albedo=R,G,B]
//               [--normal-mapped] [--glossy] [--clusters=N]
// --albedo is used for all surfaces in place of their materials'; --normal-mapped bakes transfer for normal
// maps everywhere; --glossy measures the cells of glossy materials (bench/with_material.py), whose visibility
// and bounced light share the bound as in a bake; --clusters sets the number of clusters in place of the
// best. The goals are under 16 bytes per vertex at 0.5 %, with order 5, RGB and bounces, and under 40 at
// 1.5 % if glossy.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/cell_vectors.hpp"
#include "bench/group_workload.hpp"
#include "runtime/bundle/container.hpp"

namespace {

using namespace lambent;
using namespace lambent::baker;

constexpr int kZstdLevel = 19;  // the level of bundles

struct Options {
  std::string scene;
  std::vector<float> bounds_percent = {1.0f, 0.5f, 0.3f, 0.1f}, albedo;
  int order = 5, bounces = -1;
  std::size_t rays = 512;
  std::uint32_t clusters = 0;
  bool normal_mapped = false, glossy = false;
};

struct CodedBytes {
  std::size_t clusters = 0, codebook = 0, ids = 0, weights = 0, codes = 0;
  double error = 0.0, seconds = 0.0;  // worst error; time of all calls

  std::size_t bytes() const { return codebook + ids + weights; }

  // Codes one transfer and adds it. Returns its error.
  double add(const CellVectors& cell, const CodingSettings& settings) {
    const auto packed = [](const std::vector<std::byte>& raw) {
      return std::min(raw.size(), bundle::compressZstd(raw, kZstdLevel).size());
    };
    const auto start = std::chrono::steady_clock::now();
    const CodedTransfer coded =
        codeTransfer(cell.vectors, cell.vectors.size() / cell.shape.size(), cell.shape, settings);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto own_clusters = static_cast<std::uint32_t>(coded.codebook.clusters());
    clusters += own_clusters;
    codebook += packed(transfer::encodeCodebook(coded.codebook));
    if (own_clusters > 1) ids += packed(transfer::encodeClusterIds(coded.cluster_of, own_clusters));
    for (const CodedPlane& plane : coded.planes) {
      weights += packed(transfer::encodeWeightPlane(plane.codes, plane.bits));
      codes += plane.codes.size();
    }
    return double{coded.error};
  }
};

// Adds the transfers of one cell. Visibility and bounced light of a glossy cell are shown together, and each
// gets the same share of the bound.
void addCell(const std::vector<CellVectors>& parts, bool glossy, CodingSettings settings, CodedBytes& row) {
  if (glossy) {
    for (const CellVectors& part : parts)
      settings.shown_energy += transferEnergy(part.vectors, part.shape, settings.kernel_power);
    settings.bound /= std::sqrt(static_cast<float>(parts.size()));
  }
  double square = 0.0;
  for (const CellVectors& part : parts) {
    const double error = row.add(part, settings);
    square = glossy ? square + error * error : std::max(square, error * error);
  }
  row.error = std::max(row.error, std::sqrt(square));
}

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
  app.add_flag("--glossy", options.glossy);
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
  const auto work = loadGroup(options.scene, paint, map, options.glossy);
  const SampleSet& samples = work->samples;
  std::optional<SurfaceBrdfs> brdfs;
  if (options.glossy) {
    DecodedImages images(work->scene);
    const BrdfTables tables = orExit(BrdfTables::make(work->scene, options.order, options.order));
    brdfs = orExit(SurfaceBrdfs::load(work->scene, work->geometry, tables, images, options.order));
  }
  Progress progress;
  const DirectPass pass(work->view(), {.order = options.order,
                                       .rays = options.rays,
                                       .keep_hits = options.bounces != 0,
                                       .hit_memory = std::size_t{2} << 30,
                                       .colored_kernels = brdfs && !brdfs->grey(),
                                       .order_out = options.order});
  auto direct = bakeDirect(pass, {progress});
  std::optional<BounceResult> bounced;
  if (options.bounces != 0) {
    const ExitKernels kernels{
        .grey = !brdfs || brdfs->grey(),
        .at = [&](std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out) {
          brdfs->exitKernel(triangle, u, v, to, out);
        }};
    bounced = bakeBounces({.pass = pass, .direct = *direct, .kernels = brdfs ? &kernels : nullptr},
                          {options.bounces, 1e-3, options.order}, {progress});
  }
  std::vector<std::vector<CellVectors>> cells;
  for (const SampleCell& cell : samples.cells) {
    if ((cell.kind == SampleKind::Glossy) != options.glossy) continue;
    cells.push_back(cellVectors(cell, samples, *direct, bounced ? &*bounced : nullptr,
                                {.sky = true, .lights = work->colors->greyEmission()}));
    if (options.glossy)  // without the group's own lights
      std::erase_if(cells.back(), [](const CellVectors& part) { return part.shape.order == 0; });
  }
  if (cells.empty()) {
    std::fprintf(stderr, "%s: has no such material; see bench/with_material.py\n", options.scene.c_str());
    return 1;
  }

  const auto vertices = static_cast<double>(work->geometry.positions.size());
  std::printf(
      "%s: %.0f vertices, %zu samples in %zu cells; zstd %d\n"
      " bound  clusters   axes  bytes/vertex = codebook +  ids + weights     error  seconds\n",
      options.scene.c_str(), vertices, samples.size(), cells.size(), kZstdLevel);
  for (const float percent : options.bounds_percent)
    for (const std::uint32_t clusters : {1u, options.clusters}) {
      CodedBytes row;
      CodingSettings settings{.bound = percent / 100.0f, .clusters = clusters};
      if (brdfs) settings.kernel_power = kernelPower(work->geometry, *brdfs, options.order);
      for (const std::vector<CellVectors>& cell : cells) addCell(cell, options.glossy, settings, row);
      const auto each = [&](std::size_t bytes) { return static_cast<double>(bytes) / vertices; };
      std::printf("%5.2f %%  %8zu  %5.1f  %12.2f   %8.2f  %5.2f  %8.2f  %6.3f %%  %7.2f\n", double{percent},
                  row.clusters, static_cast<double>(row.codes) / static_cast<double>(samples.size()),
                  each(row.bytes()), each(row.codebook), each(row.ids), each(row.weights), 100.0 * row.error,
                  row.seconds);
      std::fflush(stdout);
    }
  return 0;
}
