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
constexpr int kMostBandsOfMatrices = 6;
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

// The vectors of some samples.
struct Part {
  const VolumeTransfer& transfer;
  std::size_t begin, end;

  std::size_t count() const { return end - begin; }
  std::span<const float> vectors() const {
    return std::span(transfer.vectors)
        .subspan(begin * transfer.vectorSize(), count() * transfer.vectorSize());
  }
  std::span<const float> visibility() const {
    return std::span(transfer.visibility)
        .subspan(begin * transfer.visibilitySize(), count() * transfer.visibilitySize());
  }
  // With all scatterings less the unscattered light.
  std::vector<float> scattered() const {
    const std::size_t block = transfer.outputs() * transfer.columns();
    std::vector<float> out;
    out.reserve(count() * transfer.full_channels * block);
    for (std::size_t p = begin; p < end; ++p) {
      const float* const own = &transfer.vectors[p * transfer.vectorSize()];
      for (std::size_t i = 0; i < transfer.full_channels * block; ++i)
        out.push_back(own[block + i] - own[i % block]);
    }
    return out;
  }
};

bundle::TransferShape shapeOf(const VolumeTransfer& transfer) {
  bundle::TransferShape shape;
  shape.order = static_cast<std::uint32_t>(transfer.order);
  shape.full_channels = transfer.full_channels;
  shape.outputs = static_cast<std::uint32_t>(transfer.outputs());
  return shape;
}

CodedTransfer codeDense(const Part& part, float bound, const std::stop_token& stop, BakeReport& report) {
  CodedTransfer coded =
      codeTransfer(part.vectors(), part.count(), shapeOf(part.transfer), {.bound = bound}, stop);
  report.worst_error = std::max(report.worst_error, double{coded.error});
  return coded;
}

// What comes through as visibility, what is scattered as matrices; they are shown together, and errors count
// by how much of each band goes on, g^2l.
std::vector<CodedTransfer> codeMatrices(const Part& part, float bound, const std::stop_token& stop,
                                        BakeReport& report) {
  const VolumeTransfer& transfer = part.transfer;
  bundle::TransferShape visible = shapeOf(transfer), scattered = visible;
  visible.full_channels = 0;
  visible.visibility_bands = static_cast<std::uint32_t>(transfer.order + transfer.bands - 1);
  scattered.shadowed_channels = 0;
  BandPower power;
  for (std::size_t l = 0; l < power.size(); ++l)
    power[l] = std::pow(double{transfer.g}, 2.0 * static_cast<double>(l));
  std::vector<float> matrices;
  if (transfer.full_channels > 0) matrices = part.scattered();
  CodingSettings settings{.bound = bound,
                          .shown_energy = transferEnergy(part.visibility(), visible, power),
                          .kernel_power = power};
  if (!matrices.empty()) {
    settings.shown_energy += transferEnergy(matrices, scattered, power);
    settings.bound *= std::sqrt(0.5f);
  }
  std::vector<CodedTransfer> coded;
  coded.push_back(codeTransfer(part.visibility(), part.count(), visible, settings, stop));
  if (!matrices.empty() && !stop.stop_requested())
    coded.push_back(codeTransfer(matrices, part.count(), scattered, settings, stop));
  double square = 0.0;
  for (const CodedTransfer& each : coded) square += double{each.error} * double{each.error};
  report.worst_glossy_error = std::max(report.worst_glossy_error, std::sqrt(square));
  return coded;
}

// Runs of samples of nearly the same length, coded one by one.
std::vector<CodedCell> codeCells(const VolumeTransfer& transfer, const BakeOptions& options,
                                 Progress& progress, const std::stop_token& stop, BakeReport& report) {
  const std::size_t samples = transfer.grid.samples();
  const std::size_t cells = (samples + kMostSamplesInACell - 1) / kMostSamplesInACell;
  std::vector<CodedCell> coded;
  for (std::size_t c = 0; c < cells && !stop.stop_requested(); ++c) {
    const Part part{transfer, samples * c / cells, samples * (c + 1) / cells};
    CodedCell& cell = coded.emplace_back();
    cell.count = static_cast<std::uint32_t>(part.count());
    cell.bounds_min = cell.bounds_max = transfer.grid.place(part.begin);
    for (std::size_t p = part.begin; p < part.end; ++p) {
      cell.bounds_min = glm::min(cell.bounds_min, transfer.grid.place(p));
      cell.bounds_max = glm::max(cell.bounds_max, transfer.grid.place(p));
    }
    if (transfer.bands > 3)
      cell.transfers = codeMatrices(part, options.effectiveGlossyErrorBound(), stop, report);
    else
      cell.transfers.push_back(codeDense(part, options.effectiveErrorBound(), stop, report));
    progress.add(part.count());
  }
  return coded;
}

}  // namespace

QuantizedDensity quantizeDensity(std::span<const float> density) {
  const float largest = density.empty() ? 0.0f : *std::max_element(density.begin(), density.end());
  QuantizedDensity coarse = quantizedTo(density, largest, 8);
  return coarse.error <= kDensityBound ? std::move(coarse) : quantizedTo(density, largest, 16);
}

Result<void> checkVolume(const Scene& scene, const SceneVolume& volume, const BakeOptions& options) {
  const float g = volume.g;
  const std::string what = fmt::format("{}: {}", scene.source.string(), volume.name);
  const int bands = bandsOfPhase(g, options.order);
  if (bands <= 3) return {};
  if (options.order > kMostBandsOfMatrices)
    return fail(what,
                fmt::format("scatters with g = {}, which is baked with at most {} bands of light", g,
                            kMostBandsOfMatrices),
                fmt::format("give --order {}", kMostBandsOfMatrices));
  const glm::uvec3& grid = options.volume_grid;
  if (std::size_t{grid.x} * grid.y * grid.z > mostGlossySamples(bands))
    return fail(
        what,
        fmt::format("scatters with g = {}: a grid of {} x {} x {} voxels of {} numbers each is too large", g,
                    grid.x, grid.y, grid.z, bands * bands),
        fmt::format("give a --volume-grid of at most {} voxels", mostGlossySamples(bands)));
  return {};
}

Result<BakedGroup> bakeVolume(const Scene& scene, const std::vector<RigidGroup>& groups, std::size_t index,
                              const std::vector<BakedGroup>& baked,
                              const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps,
                              const BakeOptions& options, Progress& progress, const std::stop_token& stop,
                              BakeReport& report) {
  const RigidGroup& group = groups[index];
  const SceneVolume& volume = scene.volumes[static_cast<std::size_t>(group.volume)];
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
                      density.values, volume.albedo, volume.g};
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
  result.volume->cells = codeCells(*transfer, options, progress, stop, report);
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
