#include "baker/bake/bake_volume.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "baker/effects/volume/marched_volume.hpp"
#include "baker/effects/volume/volume_transfer.hpp"
#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

namespace {

constexpr double kDensityBound = 0.005;
constexpr std::size_t kMostSamplesInACell = std::size_t{1} << 16;

glm::dmat4 worldFromGroup(const RigidGroup& group) {
  return glm::translate(glm::dmat4(1.0), glm::dvec3(group.rest_translation)) *
         glm::mat4_cast(glm::dquat(group.rest_rotation));
}

QuantizedDensity quantizedTo(std::span<const float> density, float largest, std::uint32_t bits) {
  QuantizedDensity out{.bits = bits, .largest = largest, .codes = {}, .values = {}};
  const double codes = std::ldexp(1.0, static_cast<int>(bits)) - 1.0;
  double error = 0.0, energy = 0.0;
  for (const float value : density) {
    const double code = largest > 0.0f ? std::round(double{value} / double{largest} * codes) : 0.0;
    const auto stored = static_cast<std::uint32_t>(code);
    for (std::uint32_t byte = 0; byte < bits / 8; ++byte)
      out.codes.push_back(static_cast<std::byte>(stored >> (8 * byte) & 0xffu));
    out.values.push_back(static_cast<float>(double{largest} * (code / codes)));
    const double off = double{out.values.back()} - double{value};
    error += off * off;
    energy += double{value} * double{value};
  }
  out.error = energy > 0.0 ? std::sqrt(error / energy) : 0.0;
  return out;
}

// Where the light that comes in is sampled: the middle of what is there, else of the box.
glm::vec3 centreOf(const glm::uvec3& size, std::span<const float> values, const glm::mat4& group_from_grid) {
  glm::dvec3 sum(0.0);
  double mass = 0.0;
  std::size_t v = 0;
  for (std::uint32_t z = 0; z < size.z; ++z)
    for (std::uint32_t y = 0; y < size.y; ++y)
      for (std::uint32_t x = 0; x < size.x; ++x, ++v) {
        mass += double{values[v]};
        sum += double{values[v]} * (glm::dvec3(x, y, z) + 0.5);
      }
  const glm::dvec3 grid = mass > 0.0 ? sum / mass : 0.5 * glm::dvec3(size);
  return glm::vec3(glm::dmat4(group_from_grid) * glm::dvec4(grid, 1.0));
}

// Runs of samples of nearly the same length, coded one by one.
std::vector<CodedCell> codeCells(const VolumeTransfer& transfer, float bound, Progress& progress,
                                 const std::stop_token& stop, BakeReport& report) {
  const std::size_t samples = transfer.grid.samples();
  const std::size_t cells = (samples + kMostSamplesInACell - 1) / kMostSamplesInACell;
  bundle::TransferShape shape;
  shape.order = static_cast<std::uint32_t>(transfer.order);
  shape.shadowed_channels = 1;
  shape.full_channels = transfer.full_channels;
  std::vector<CodedCell> coded;
  for (std::size_t c = 0; c < cells && !stop.stop_requested(); ++c) {
    const std::size_t begin = samples * c / cells, end = samples * (c + 1) / cells;
    CodedCell& cell = coded.emplace_back();
    cell.count = static_cast<std::uint32_t>(end - begin);
    cell.bounds_min = cell.bounds_max = transfer.grid.place(begin);
    for (std::size_t p = begin; p < end; ++p) {
      cell.bounds_min = glm::min(cell.bounds_min, transfer.grid.place(p));
      cell.bounds_max = glm::max(cell.bounds_max, transfer.grid.place(p));
    }
    const auto vectors = std::span(transfer.vectors)
                             .subspan(begin * transfer.vectorSize(), (end - begin) * transfer.vectorSize());
    cell.transfers.push_back(codeTransfer(vectors, end - begin, shape, {.bound = bound}, stop));
    report.worst_error = std::max(report.worst_error, double{cell.transfers.back().error});
    progress.add(end - begin);
  }
  return coded;
}

}  // namespace

QuantizedDensity quantizeDensity(std::span<const float> density) {
  const float largest = density.empty() ? 0.0f : *std::max_element(density.begin(), density.end());
  QuantizedDensity coarse = quantizedTo(density, largest, 8);
  return coarse.error <= kDensityBound ? std::move(coarse) : quantizedTo(density, largest, 16);
}

Result<BakedGroup> bakeVolume(const Scene& scene, const std::vector<RigidGroup>& groups, std::size_t index,
                              const std::vector<BakedGroup>& baked,
                              const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps,
                              const BakeOptions& options, Progress& progress, const std::stop_token& stop,
                              BakeReport& report) {
  const RigidGroup& group = groups[index];
  const SceneVolume& volume = scene.volumes[static_cast<std::size_t>(group.volume)];
  if (volume.g != 0.0f)
    return fail(fmt::format("{}: {}", scene.source.string(), volume.name),
                fmt::format("scatters with g = {}, and g other than 0 is not yet baked", volume.g),
                "set g to 0");
  progress.begin("density");
  const QuantizedDensity density = quantizeDensity(volume.density);
  const glm::dmat4 group_from_world = glm::inverse(worldFromGroup(group));
  const glm::dmat4 world_from_node(gltf::worldTransforms(scene.nodes)[volume.node]);
  const glm::mat4 group_from_grid(group_from_world * world_from_node * glm::dmat4(volume.node_from_grid));

  // The surfaces that it never moves against, from where they lie (GroupGeometry::origin).
  std::optional<RayScene> rays;
  Occluders occluders;
  if (group.within >= 0) {
    const auto within = static_cast<std::size_t>(group.within);
    const GroupGeometry& geometry = baked[within].geometry;
    auto built = RayScene::build(geometry, scene, alpha_maps);
    if (!built) return failAgain(built.error());
    rays = std::move(*built);
    occluders =
        Occluders(*rays, glm::mat4(glm::translate(glm::dmat4(1.0), -glm::dvec3(geometry.origin)) *
                                   glm::inverse(worldFromGroup(groups[within])) * worldFromGroup(group)));
  }

  const Medium medium{std::make_shared<DensityField>(volume.size, density.values, group_from_grid),
                      density.values, volume.albedo};
  const VolumeSettings settings{.order = options.order,
                                .rays = options.effectiveRays(),
                                // As the reference: bounces are counted between surfaces, not in volumes.
                                .scatterings = options.bounces == 0 ? 0 : -1,
                                .grid = options.volume_grid,
                                .memory = options.effectiveMemory() / 2};
  const std::size_t stages_before = progress.finished().size();
  auto transfer = bakeVolumeTransfer(medium, settings, occluders, progress, stop);
  progress.end();
  const std::vector<Progress::Stage> stages = progress.finished();
  for (const Progress::Stage& stage : std::span(stages).subspan(stages_before))
    if (stage.unit == "samples") report.ray_seconds += stage.seconds;
  const auto stopped = [&] { return fail(scene.source.string(), "stopped; nothing was written"); };
  if (!transfer) return stopped();

  progress.begin("coding", transfer->grid.samples(), "samples");
  BakedGroup result;
  result.light_samples.points = {centreOf(volume.size, density.values, group_from_grid)};
  result.volume = BakedVolume{.size = volume.size,
                              .group_from_grid = group_from_grid,
                              .bits = density.bits,
                              .density = density.codes,
                              .density_max = density.largest,
                              .albedo = volume.albedo,
                              .g = volume.g,
                              .transfer_size = options.volume_grid,
                              .voxels = transfer->grid.voxels(),
                              .cells = {},
                              .light_sample = result.light_samples.points.front()};
  result.volume->cells = codeCells(*transfer, options.effectiveErrorBound(), progress, stop, report);
  if (stop.stop_requested()) return stopped();

  report.samples += transfer->grid.samples();
  report.rays += transfer->rays;
  report.volumes.push_back({.name = volume.name,
                            .voxels = volume.density.size(),
                            .samples = transfer->grid.samples(),
                            .density_bits = density.bits,
                            .density_error = density.error,
                            .iterations = transfer->iterations,
                            .residual = transfer->residual,
                            .row_bytes = transfer->row_bytes});
  report.groups.push_back({.name = group.name, .light_samples = 1, .proxy_triangles = {}});
  result.volume_light = std::make_shared<MarchedVolume>(std::move(*transfer));
  return result;
}

}  // namespace lambent::baker
