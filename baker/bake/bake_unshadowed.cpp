#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "baker/bake/bake.hpp"
#include "baker/bake/bake_group.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/effects/volume/volume.hpp"
#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr float kY00 = 0.282094792f;
// The coding bound for a single vector, where a looser one would save next to nothing.
constexpr float kBound = 1e-5f;
// Outputs of up to so many bands are stored as they are, those of more bands as visibility.
constexpr std::uint32_t kDenseBands = 3;

// Returns the transfer of a place that sees everything: with one output the mean of the light, else the light
// itself.
CodedTransfer openTransfer(int order, std::uint32_t outputs) {
  transfer::TransferShape shape;
  shape.order = static_cast<std::uint32_t>(order);
  shape.outputs = outputs;
  const bool as_visibility = outputs > kDenseBands * kDenseBands;
  if (as_visibility) shape.visibility_bands = shape.order + transfer::bandsOf(outputs) - 1;
  std::vector<float> vector(shape.size(), 0.0f);
  if (as_visibility)
    vector[0] = std::sqrt(4.0f * std::numbers::pi_v<float>);  // V = 1
  else if (outputs == 1)
    vector[0] = kY00;
  else
    for (std::uint32_t j = 0; j < std::min(outputs, shape.columns()); ++j)
      vector[j * shape.columns() + j] = 1.0f;
  return codeTransfer(vector, 1, shape, {.bound = kBound});
}

// Making BRDF tables takes longer than all else here, so glossy surfaces are diffuse until they exist.
BakedGroup openSurfaces(const Scene& scene, const RigidGroup& group, const ShippedMeshes& meshes,
                        const BakeOptions& options) {
  BakedGroup baked;
  baked.geometry = buildGroupGeometry(group, scene, meshes.decoded, /*with_glossy=*/false);
  // A cell with one sample in the middle belongs to no vertex: it says how many bands of light the group
  // takes.
  const glm::vec3 center = 0.5f * (baked.geometry.bounds_min + baked.geometry.bounds_max);
  baked.light_probes.points = {center};
  baked.light_probes.cells.push_back({{0}, {}});
  baked.samples.positions.push_back(center);
  baked.samples.cells.push_back({0, 1, center, center, SampleKind::Diffuse});
  baked.surfaces.cells.push_back({openTransfer(options.order, 1)});
  baked.samples.vertex_sample.assign(baked.geometry.positions.size(), kNoSample);
  return baked;
}

// The transfer of the volume is one voxel that fills its box.
BakedGroup openVolume(const Scene& scene, const RigidGroup& group, const BakeOptions& options) {
  const SceneVolume& volume = scene.volumes[static_cast<std::size_t>(group.volume)];
  BakedGroup baked;
  baked.volume = placeVolume(scene, group, quantizeDensity(volume.density));
  baked.light_probes.points = {baked.volume->light_probe};
  const auto bands = static_cast<std::uint32_t>(bandsOfPhase(volume.g, options.order));
  CodedCell& cell = baked.volume->cells.emplace_back();
  cell.count = 1;
  cell.bounds_min = cell.bounds_max = baked.volume->light_probe;
  cell.transfers.push_back(openTransfer(options.order, bands * bands));
  baked.volume->voxels = {0};
  return baked;
}

Result<BakeReport> bakeUnshadowedOnTheseThreads(const Scene& scene, const BakeOptions& options,
                                                const std::filesystem::path& output,
                                                const BakeContext& context) {
  BakeReport report;
  context.progress.begin("plan");
  const auto plan = planFor(scene, options);
  if (!plan) return failAgain(plan.error());
  const BrdfTables tables;
  auto split = splitMeshes(scene, plan->groups, options.max_edge_m);
  if (!split) return failAgain(split.error());
  auto meshes = shipMeshes(scene, plan->groups, std::move(*split), context);
  if (!meshes) return failAgain(meshes.error());

  context.progress.begin("writing");
  std::vector<BakedGroup> baked;
  for (const RigidGroup& group : plan->groups) {
    baked.push_back(group.volume >= 0 ? openVolume(scene, group, options)
                                      : openSurfaces(scene, group, *meshes, options));
    report.vertices += baked.back().geometry.positions.size();
    report.triangles += baked.back().geometry.triangles.size();
  }
  const SceneBake whole{scene, options, *plan, tables};
  AssembledBundle bundle = assemble(whole, std::move(*meshes), baked, report);
  bundle.description.generator.settings["transfer"] = "none";
  if (context.stopped()) return whole.stopped();
  if (auto written = bundle::write(output, std::move(bundle.description), bundle.blobs); !written)
    return failAgain(written.error());
  context.progress.end();
  std::error_code ignored;
  report.file_bytes = std::filesystem::file_size(output, ignored);
  report.stages = context.progress.finished();
  return report;
}

}  // namespace

Result<BakeReport> bakeUnshadowed(const Scene& scene, const BakeOptions& options,
                                  const std::filesystem::path& output, const BakeContext& context) {
  if (auto checked = checkRequest(options, output); !checked) return failAgain(checked.error());
  std::optional<Result<BakeReport>> result;
  withThreads(options.threads,
              [&] { result = bakeUnshadowedOnTheseThreads(scene, options, output, context); });
  return std::move(*result);
}

}  // namespace lambent::baker
