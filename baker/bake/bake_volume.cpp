#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "baker/bake/bake_group.hpp"
#include "baker/bake/group_scene.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "baker/effects/neighborhood/bodies.hpp"
#include "baker/effects/volume/volume.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/ray_scene.hpp"
#include "runtime/base/process.hpp"

namespace lambent::baker {

// A CodedVolume is what of a volume goes into the bundle, and what the report says of it.
struct CodedVolume {
  std::vector<std::uint32_t> voxels;
  std::vector<CodedCell> cells;
  double worst_error = 0.0, worst_glossy_error = 0.0, residual = 0.0;
  std::uint64_t rays = 0, rays_kept = 0, row_bytes = 0;
  int iterations = 0;
};
template <>
inline constexpr auto kKeptMembers<CodedVolume> = std::tuple(&CodedVolume::voxels, &CodedVolume::cells,
                                                             &CodedVolume::worst_error,
                                                             &CodedVolume::worst_glossy_error,
                                                             &CodedVolume::residual, &CodedVolume::rays,
                                                             &CodedVolume::rays_kept, &CodedVolume::row_bytes,
                                                             &CodedVolume::iterations);

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

// Returns where incoming light is sampled: the centre of mass of the density, or of the box if it is empty.
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

transfer::TransferShape shapeOf(const VolumeTransfer& transfer) {
  transfer::TransferShape shape;
  shape.order = static_cast<std::uint32_t>(transfer.order);
  shape.full_channels = transfer.full_channels;
  shape.outputs = static_cast<std::uint32_t>(transfer.outputs());
  return shape;
}

// Codes transmitted light as visibility and scattered light as matrices. They are shown together, and errors
// count by how much of each band the phase function keeps, g^2l.
std::vector<CodedTransfer> codeMatrices(const VolumeTransfer& transfer, std::size_t begin, std::size_t count,
                                        const BakeOptions& options, CachedCoding& coding, CodedVolume& out) {
  transfer::TransferShape visible = shapeOf(transfer), scattered = visible;
  visible.full_channels = 0;
  visible.visibility_bands = static_cast<std::uint32_t>(transfer.order + transfer.bands - 1);
  scattered.shadowed_channels = 0;
  BandPower power;
  for (std::size_t l = 0; l < power.size(); ++l)
    power[l] = std::pow(double{transfer.g}, 2.0 * static_cast<double>(l));
  const auto visibility = std::span(transfer.visibility)
                              .subspan(begin * transfer.visibilitySize(), count * transfer.visibilitySize());
  // All scatterings, less the unscattered light.
  const std::size_t block = transfer.outputs() * transfer.columns();
  std::vector<float> matrices;
  for (std::size_t p = begin; p < begin + count; ++p) {
    const float* const own = &transfer.vectors[p * transfer.vectorSize()];
    for (std::size_t i = 0; i < transfer.full_channels * block; ++i)
      matrices.push_back(own[block + i] - own[i % block]);
  }
  CodingSettings settings{.bound = options.effectiveGlossyErrorBound(),
                          .shown_energy = transferEnergy(visibility, visible, power),
                          .kernel_power = power};
  if (!matrices.empty()) {
    settings.shown_energy += transferEnergy(matrices, scattered, power);
    settings.bound *= std::sqrt(0.5f);
  }
  std::vector<CodedTransfer> coded;
  coded.push_back(coding.code(visibility, count, visible, settings));
  if (!matrices.empty() && !coding.stopped())
    coded.push_back(coding.code(matrices, count, scattered, settings));
  double square = 0.0;
  for (const CodedTransfer& each : coded) square += double{each.error} * double{each.error};
  out.worst_glossy_error = std::max(out.worst_glossy_error, std::sqrt(square));
  return coded;
}

// Cuts the samples into cells of nearly the same size and codes one after the other. Returns false if
// stopped.
bool codeCells(const VolumeTransfer& transfer, const BakeOptions& options, CachedCoding& coding,
               Progress& progress, CodedVolume& out) {
  const std::size_t samples = transfer.grid.samples();
  const std::size_t cells = (samples + kMostSamplesInACell - 1) / kMostSamplesInACell;
  out.voxels = transfer.grid.voxels();
  out.rays = transfer.rays, out.rays_kept = transfer.rays_kept, out.row_bytes = transfer.row_bytes;
  out.iterations = transfer.iterations, out.residual = transfer.residual;
  progress.begin("coding", samples, "samples");
  for (std::size_t c = 0; c < cells && !coding.stopped(); ++c) {
    const std::size_t begin = samples * c / cells, count = samples * (c + 1) / cells - begin;
    CodedCell& cell = out.cells.emplace_back();
    cell.count = static_cast<std::uint32_t>(count);
    cell.bounds_min = cell.bounds_max = transfer.grid.place(begin);
    for (std::size_t p = begin; p < begin + count; ++p) {
      cell.bounds_min = glm::min(cell.bounds_min, transfer.grid.place(p));
      cell.bounds_max = glm::max(cell.bounds_max, transfer.grid.place(p));
    }
    if (transfer.bands > 3) {
      cell.transfers = codeMatrices(transfer, begin, count, options, coding, out);
    } else {
      const auto vectors =
          std::span(transfer.vectors).subspan(begin * transfer.vectorSize(), count * transfer.vectorSize());
      cell.transfers.push_back(
          coding.code(vectors, count, shapeOf(transfer), {.bound = options.effectiveErrorBound()}));
      out.worst_error = std::max(out.worst_error, double{cell.transfers[0].error});
    }
    progress.add(count);
  }
  return !coding.stopped();
}

// Within holds the surfaces that a volume never moves against.
struct Within {
  const GroupGeometry* geometry = nullptr;  // null if there are none
  glm::mat4 from_group{1.0f};  // from the volume's group to points relative to GroupGeometry::origin
};

Within surfacesAround(const std::vector<RigidGroup>& groups, std::size_t index,
                      const std::vector<BakedGroup>& baked) {
  const RigidGroup& group = groups[index];
  if (group.within < 0) return {};
  const auto w = static_cast<std::size_t>(group.within);
  const GroupGeometry& geometry = baked[w].geometry;
  return {&geometry, glm::mat4(glm::translate(glm::dmat4(1.0), -glm::dvec3(geometry.origin)) *
                               glm::inverse(worldFromGroup(groups[w])) * worldFromGroup(group))};
}

// Returns the key of a volume's transfer, from the medium as it ships and the surfaces that it never moves
// against.
Key transferKey(const Scene& scene, const BakedVolume& placed, const VolumeSettings& settings,
                const Within& within) {
  KeyMaker key = KeyMaker::ofStage("volume");
  key.addList(placed.density).add(placed.bits).add(placed.density_max).add(placed.size);
  key.add(placed.group_from_grid).add(placed.albedo).add(placed.g);
  key.add(settings.order).add(std::uint64_t{settings.rays}).add(settings.scatterings).add(settings.grid);
  key.add(settings.fit_within_voxels);
  key.add(within.geometry != nullptr);
  if (within.geometry) {
    addShape(*within.geometry, key);
    addOpacity(scene, *within.geometry, key);
    key.add(within.from_group);
  }
  return key.key();
}

// A PlacedVolume is a volume in its group, and how its transfer is baked.
struct PlacedVolume {
  const SceneBake& bake;
  DecodedImages& images;
  const SceneVolume& volume;
  const QuantizedDensity& density;
  const glm::mat4& group_from_grid;
  Within within;
  VolumeSettings settings;
};

// Adds to `ray_seconds`. Errors: no memory for the hierarchy, "stopped".
Result<VolumeTransfer> transferOf(const PlacedVolume& placed, const BakeContext& context,
                                  double& ray_seconds) {
  std::optional<RayScene> rays;
  Occluders occluders;
  if (placed.within.geometry) {
    auto built = RayScene::build(*placed.within.geometry, placed.bake.scene, placed.images);
    if (!built) return failAgain(built.error());
    rays = std::move(*built);
    occluders = Occluders(*rays, placed.within.from_group);
  }
  const auto field =
      std::make_shared<DensityField>(placed.volume.size, placed.density.values, placed.group_from_grid);
  const Medium medium{field, placed.density.values, placed.volume.albedo, placed.volume.g};
  const std::size_t stages_before = context.progress.finished().size();
  auto transfer = bakeVolumeTransfer(medium, placed.settings, occluders, context);
  context.progress.end();
  const std::vector<Progress::Stage> stages = context.progress.finished();
  for (const Progress::Stage& stage : std::span(stages).subspan(stages_before))
    if (stage.unit == "samples" || stage.unit == "places") ray_seconds += stage.seconds;
  if (!transfer) return placed.bake.stopped();
  return std::move(*transfer);
}

void reportVolume(const CodedVolume& coded, const SceneVolume& volume, const QuantizedDensity& density,
                  const std::string& name, BakeReport& report) {
  report.worst_error = std::max(report.worst_error, coded.worst_error);
  report.worst_glossy_error = std::max(report.worst_glossy_error, coded.worst_glossy_error);
  report.samples += coded.voxels.size();
  report.rays += coded.rays;
  report.rays_kept += coded.rays_kept;
  report.volumes.push_back({.name = volume.name,
                            .voxels = volume.density.size(),
                            .samples = coded.voxels.size(),
                            .density_bits = density.bits,
                            .density_error = density.error,
                            .iterations = coded.iterations,
                            .residual = coded.residual,
                            .row_bytes = coded.row_bytes});
  report.groups.push_back({.name = name, .light_probes = 1, .proxy_triangles = {}, .effects = {}});
}

}  // namespace

QuantizedDensity quantizeDensity(std::span<const float> density) {
  const float largest = density.empty() ? 0.0f : *std::max_element(density.begin(), density.end());
  QuantizedDensity coarse = quantizedTo(density, largest, 8);
  return coarse.error <= kDensityBound ? std::move(coarse) : quantizedTo(density, largest, 16);
}

BakedVolume placeVolume(const Scene& scene, const RigidGroup& group, const QuantizedDensity& density) {
  const SceneVolume& volume = scene.volumes[static_cast<std::size_t>(group.volume)];
  const glm::dmat4 group_from_world = glm::inverse(worldFromGroup(group));
  const glm::dmat4 world_from_node(gltf::worldTransforms(scene.nodes)[volume.node]);
  BakedVolume placed{
      .size = volume.size,
      .group_from_grid = glm::mat4(group_from_world * world_from_node * glm::dmat4(volume.node_from_grid)),
      .bits = density.bits,
      .density = density.codes,
      .density_max = density.largest,
      .albedo = volume.albedo,
      .g = volume.g,
      .transfer_size = glm::uvec3(1),
      .voxels = {},
      .cells = {}};
  placed.light_probe = centreOf(volume.size, density.values, placed.group_from_grid);
  return placed;
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

Result<BakedGroup> bakeVolume(const SceneBake& bake, DecodedImages& images, std::size_t index,
                              const std::vector<BakedGroup>& baked, const BakeContext& context,
                              BakeReport& report) {
  const auto& [scene, options, plan, tables] = bake;
  const RigidGroup& group = plan.groups[index];
  const SceneVolume& volume = scene.volumes[static_cast<std::size_t>(group.volume)];
  context.progress.begin("density");
  const QuantizedDensity density = quantizeDensity(volume.density);
  BakedGroup result;
  result.volume = placeVolume(scene, group, density);
  BakedVolume& out = *result.volume;
  out.transfer_size = options.volume_grid;
  result.light_probes.points = {out.light_probe};
  const PlacedVolume placed{bake,
                            images,
                            volume,
                            density,
                            out.group_from_grid,
                            surfacesAround(plan.groups, index, baked),
                            {.order = options.order,
                             .rays = options.effectiveRays(),
                             // As in the reference, bounces are counted between surfaces, not in volumes.
                             .scatterings = options.bounces == 0 ? 0 : -1,
                             .grid = options.volume_grid,
                             .memory = options.memoryLeft(residentBytes(), 0, 0) / 2,
                             .fit_within_voxels = true}};
  const BakeContext own =
      context.keyed(context.cache ? transferKey(scene, out, placed.settings, placed.within) : Key{});

  CodedVolume coded;
  CachedCoding coding(context);
  // The transfer is baked only if a result that follows from it is not in the cache.
  std::optional<VolumeTransfer> light;
  const auto transfer = [&]() -> Result<void> {
    if (light) return {};
    auto baked_light = transferOf(placed, own, report.ray_seconds);
    if (!baked_light) return failAgain(baked_light.error());
    light.emplace(std::move(*baked_light));
    return {};
  };
  Result<void> made;
  const BakeContext cells_context =
      own.part("cells", options.effectiveErrorBound(), options.effectiveGlossyErrorBound());
  const auto found = findOrMake(cells_context, coded, [&] {
    coded = {};
    made = transfer();
    if (made && !codeCells(*light, options, coding, context.progress, coded)) made = bake.stopped();
    return made.has_value();
  });
  if (!found) return failAgain(made.error());
  if (*found) coded.rays_kept += std::exchange(coded.rays, 0);
  coding.drop();
  reportVolume(coded, volume, density, group.name, report);
  out.voxels = std::move(coded.voxels);
  out.cells = std::move(coded.cells);

  const auto [low, high] = out.bounds();
  const auto body = [&]() -> Result<std::unique_ptr<Body>> {
    if (auto marched = transfer(); !marched) return failAgain(marched.error());
    const auto march = [&](const glm::vec3& origin, const glm::vec3& direction, float t_max,
                           std::span<float> scattered) {
      return marchVolume(*light, origin, direction, t_max, scattered);
    };
    return std::make_unique<VolumeBody>(march, light->order, low, high);
  };
  // A medium has no sharp rim to find, and each ray is marched.
  const Around around{bake, index, glm::vec3(0.0f), {low, high}, options.effectiveRays() / 4};
  if (auto done = bakeAround(around, own, body, result, report); !done) return failAgain(done.error());
  return result;
}

}  // namespace lambent::baker
