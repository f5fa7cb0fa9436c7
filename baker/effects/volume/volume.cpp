#include "baker/effects/volume/volume.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <vector>

#include "baker/effects/volume/fit_within_voxels.hpp"
#include "baker/effects/volume/phase_scattering.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/volume_rays.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kSamplesPerRange = 16, kRowsPerRange = 64;
constexpr std::size_t kRaysPerOutput = 6;
// The number of the solver's vectors depends on the size of the system, not on the machine's memory, so that
// results do not either.
constexpr std::uint64_t kSolverBytes = std::uint64_t{1} << 30, kLeastKept = 6, kMostKept = 24;

// FirstLights hold the light that reaches samples unscattered, and how much the medium takes.
struct FirstLights {
  // [sample][columns of the table]. With an anisotropic phase function it is the transmittance tau(s) by
  // direction, through the medium and past the surfaces: with incident light l, the coefficients
  //   L_i = sum_jk Gamma_ijk tau_k l_j
  // arrive. This is exact with tau in order + bands - 1 bands (literature 1.9).
  std::vector<float> transfer;
  std::vector<float> clear;        // [sample][outputs], as in FirstLight::look; empty with one output
  std::vector<double> met, out;    // [sample], as in Arrival
  std::size_t samples_traced = 0;  // in this run; the others were found in the cache
};

std::optional<FirstLights> lightIn(const VolumeScene& scene, const SphereTable& table, std::size_t outputs,
                                   const BakeContext& context) {
  const std::size_t samples = scene.grid.samples(), columns = table.harmonics(0).size();
  const bool phased = outputs > 1;
  FirstLights light{.transfer = std::vector<float>(samples * columns),
                    .clear = std::vector<float>(phased ? samples * outputs : 0),
                    .met = std::vector<double>(samples),
                    .out = std::vector<double>(samples)};
  const auto compute = [&](std::size_t begin, std::size_t end) {
    FirstLight first(scene.density, scene.occluders);
    for (std::size_t p = begin; p < end; ++p) {
      const auto transfer = std::span(light.transfer).subspan(p * columns, columns);
      const auto clear = phased ? std::span(light.clear).subspan(p * outputs, outputs) : std::span<float>();
      const Arrival arrival = first.look(scene.grid.place(p), table, transfer, clear);
      light.met[p] = arrival.met;
      light.out[p] = arrival.out;
    }
  };
  std::vector<Output> writes = {rowsOf(light.transfer, columns)};
  if (phased)
    writes.push_back(rowsOf(light.clear, outputs));
  else
    writes.insert(writes.end(), {rowsOf(light.met), rowsOf(light.out)});
  const auto done = runStage({.name = "light into volumes",
                              .count = samples,
                              .grain = kSamplesPerRange,
                              .writes = std::move(writes),
                              .compute = compute},
                             context);
  if (!done) return std::nullopt;
  light.samples_traced = done->computed;
  return light;
}

using Apply = std::function<bool(std::span<const float> x, std::span<float> y)>;

// Solves T = T0 + w K T for a block of columns, [row][kBlockColumns], scaled by the diagonal: the light that
// a row sends to itself is taken out of the iteration, so that thick media converge too.
class Scattering {
 public:
  // `apply` computes y = K x without a part on the diagonal: K x = y + stays x, and without k_pp it is
  // y + rest x. `scale` is 1 / (1 - w k_pp).
  struct Row {
    double scale, rest, stays;
  };
  // `kept_vectors` is the number of basis vectors that the solver keeps.
  Scattering(const Apply& apply, double albedo, int kept_vectors, std::vector<Row> rows)
      : apply_(apply), albedo_(albedo), kept_vectors_(kept_vectors), rows_(std::move(rows)) {}

  GmresResult solve(std::span<const float> first, std::span<float> result) const {
    std::vector<float> right(first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      right[i] = static_cast<float>(double{first[i]} * rows_[i / kBlockColumns].scale);
    std::copy(right.begin(), right.end(), result.begin());
    const auto apply = [&](std::span<const float> x, std::span<float> y) {
      if (!apply_(x, y)) return false;
      parallelRanges(rows_.size(), kRowsPerRange, {}, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin * kBlockColumns; i < end * kBlockColumns; ++i) {
          const Row& row = rows_[i / kBlockColumns];
          y[i] = static_cast<float>(albedo_ * row.scale * (double{y[i]} + row.rest * double{x[i]}));
        }
      });
      return true;
    };
    return solveGmres(right, result, apply, {.tolerance = kScatteringTolerance, .restart = kept_vectors_});
  }

  // Computes so many scatterings one after the other.
  GmresResult repeat(std::span<const float> first, std::span<float> result, int times) const {
    std::copy(first.begin(), first.end(), result.begin());
    std::vector<float> others(first.size());
    for (int k = 0; k < times; ++k) {
      if (!apply_(result, others)) return {k, 0.0, true};
      for (std::size_t i = 0; i < first.size(); ++i)
        result[i] = static_cast<float>(
            double{first[i]} +
            albedo_ * (rows_[i / kBlockColumns].stays * double{result[i]} + double{others[i]}));
    }
    return {times, 0.0, false};
  }

 private:
  const Apply& apply_;
  double albedo_;
  int kept_vectors_;
  std::vector<Row> rows_;
};

// Adds scattered light to the first light of a volume: solves for each channel and each block of columns.
// `make` returns the system for an albedo, whose rows are the outputs of samples. The first light is the
// first block of each of out.vectors, and the channels follow it. Returns false if stopped.
bool scatterLight(const std::function<Scattering(double albedo)>& make, const VolumeSettings& settings,
                  VolumeTransfer& out, const BakeContext& context) {
  context.progress.begin("scattered light", out.columns() * out.full_channels, "columns");
  const std::size_t columns = out.columns(), block_size = out.outputs() * columns,
                    rows = out.grid.samples() * out.outputs();
  // A row is one output of a sample; this returns where its columns start in the vectors.
  const auto at = [&](std::size_t row, std::size_t block) {
    return &out.vectors[row / out.outputs() * out.vectorSize() + block * block_size +
                        row % out.outputs() * columns];
  };
  std::vector<float> first(rows * kBlockColumns), result(first.size());
  for (std::size_t begin = 0; begin < columns; begin += kBlockColumns) {
    const std::size_t width = std::min(kBlockColumns, columns - begin);
    std::fill(first.begin(), first.end(), 0.0f);
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(at(row, 0) + begin, width, &first[row * kBlockColumns]);
    for (std::uint32_t channel = 0; channel < out.full_channels; ++channel) {
      const Scattering system = make(std::min(double{out.albedo[static_cast<int>(channel)]}, kLargestAlbedo));
      SolvedBlock solved{{}, result};
      const auto found = findOrMake(context.part("block", begin, channel).part("solved"), solved, [&] {
        solved.result = settings.scatterings < 0 ? system.solve(first, result)
                                                 : system.repeat(first, result, settings.scatterings);
        return !solved.result.stopped;
      });
      if (!found) return false;
      out.iterations = std::max(out.iterations, solved.result.iterations);
      out.residual = std::max(out.residual, solved.result.residual);
      for (std::size_t row = 0; row < rows; ++row)
        std::copy_n(&result[row * kBlockColumns], width, at(row, 1 + channel) + begin);
      context.progress.add(width);
    }
  }
  return true;
}

// Bakes the radiance that arrives at samples, in bands, for an anisotropic phase function. Grid, order, bands
// and channels of `out` are set. Returns false if stopped.
bool bakePhasedTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                        VolumeTransfer& out, const BakeContext& context) {
  const std::size_t samples = out.grid.samples(), outputs = out.outputs();
  const VolumeScene scene{*medium.density, out.grid, occluders};
  const SphereTable table(settings.rays, out.order + out.bands - 1);
  auto light = lightIn(scene, table, outputs, context.part("light"));
  if (!light) return false;
  out.rays = light->samples_traced * table.size();
  out.rays_kept = (samples - light->samples_traced) * table.size();
  const sh::GauntTable products = sh::makeGauntTable(out.order, out.bands);
  const std::size_t visibility = out.visibilitySize();
  parallelRanges(samples, kRowsPerRange, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      sh::addVisibilityMatrix(products, std::span(light->transfer).subspan(p * visibility, visibility),
                              std::span(out.vectors).subspan(p * out.vectorSize(), outputs * out.columns()));
  });
  if (out.bands > 3) out.visibility = std::move(light->transfer);
  if (out.full_channels == 0) return true;

  const SphereTable few(
      std::max({kLeastScatteringRays, kRaysPerOutput * outputs, settings.rays / kRaysPerScatteringRay}),
      out.bands);
  auto scattering = PhaseScattering::build(scene, few, light->clear,
                                           {.bands = out.bands, .g = out.g, .memory = settings.memory},
                                           context.part("rows"));
  if (!scattering) return false;
  out.rays += scattering->samplesTraced() * few.size();
  out.rays_kept += (samples - scattering->samplesTraced()) * few.size();
  out.row_bytes = scattering->bytes();
  const std::uint64_t vector = 4 * samples * outputs * kBlockColumns;
  const auto kept_vectors = static_cast<int>(std::clamp(kSolverBytes / vector, kLeastKept, kMostKept));
  const Apply apply = [&](std::span<const float> x, std::span<float> y) {
    return scattering->apply(x, y, context.stop);
  };
  const auto system = [&](double albedo) {
    std::vector<Scattering::Row> rows;
    for (std::size_t p = 0; p < samples; ++p)
      for (std::size_t i = 0; i < outputs; ++i) {
        // This computes 1 - w g^l k_pp without subtracting two numbers near 1.
        const double factor = scattering->factor(i), away = scattering->away(p), stays = albedo * factor;
        rows.push_back({.scale = 1.0 / std::max(1.0 - stays + stays * away, 1e-30),
                        .rest = factor * away,
                        .stays = factor});
      }
    return Scattering(apply, albedo, kept_vectors, std::move(rows));
  };
  return scatterLight(system, settings, out, context);
}

// Removes the checkpoints, once all parts are complete.
void dropParts(const BakeContext& context, const VolumeTransfer& transfer) {
  if (!context.keeps()) return;
  const std::size_t samples = transfer.grid.samples();
  dropStage(context.part("light"), samples, kSamplesPerRange);
  if (transfer.bands > 1) {
    PhaseScattering::drop(context.part("rows"), samples);
  } else {
    ScatterRows::drop(context.part("rows"), samples);
    dropWithinVoxels(context.part("within voxels"), *transfer.density, transfer.grid);
  }
  for (std::size_t block = 0; block < transfer.columns(); block += kBlockColumns)
    for (std::uint32_t channel = 0; channel < transfer.full_channels; ++channel)
      dropValue(context.part("block", block, channel).part("solved"));
}

bool bakeTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                  VolumeTransfer& out, const BakeContext& context) {
  const std::size_t samples = out.grid.samples(), columns = out.columns();
  out.rays_kept = 0, out.visibility.clear();
  out.vectors.assign(samples * out.vectorSize(), 0.0f);
  if (samples == 0) return true;
  if (out.bands > 1) return bakePhasedTransfer(medium, settings, occluders, out, context);

  const VolumeScene scene{*medium.density, out.grid, occluders};
  const SphereTable table(settings.rays, settings.order);
  const auto light = lightIn(scene, table, /*outputs=*/1, context.part("light"));
  if (!light) return false;
  out.rays = light->samples_traced * table.size();
  out.rays_kept = samples * table.size() - out.rays;
  for (std::size_t p = 0; p < samples; ++p)
    std::copy_n(&light->transfer[p * columns], columns, &out.vectors[p * out.vectorSize()]);
  const auto fit = [&](const ScatterRows* rows) {
    return !settings.fit_within_voxels ||
           fitWithinVoxels(medium, settings, occluders, rows, out, context.part("within voxels"));
  };
  if (out.full_channels == 0) return fit(nullptr);

  const SphereTable few(std::max(kLeastScatteringRays, settings.rays / kRaysPerScatteringRay), 1);
  const auto rows = ScatterRows::build(scene, few, light->met, settings.memory, context.part("rows"));
  if (!rows) return false;
  out.rays += rows->samplesTraced() * few.size();
  out.rays_kept += (samples - rows->samplesTraced()) * few.size();
  out.row_bytes = rows->bytes();
  std::vector<float> nodes(out.grid.nodes() * kBlockColumns);
  const Apply apply = [&](std::span<const float> x, std::span<float> y) {
    std::copy(x.begin(), x.end(), nodes.begin());
    return rows->apply(nodes, y, context.stop);
  };
  const auto system = [&](double albedo) {
    std::vector<Scattering::Row> own;
    for (std::size_t p = 0; p < samples; ++p) {
      // This computes 1 - w k_pp without subtracting two numbers near 1.
      const double kept = 1.0 - albedo + albedo * (rows->others(p) + light->out[p]);
      own.push_back({.scale = kept > 1e-30 ? 1.0 / kept : 0.0, .rest = 0.0, .stays = rows->self(p)});
    }
    return Scattering(apply, albedo, static_cast<int>(kMostKept), std::move(own));
  };
  return scatterLight(system, settings, out, context) && fit(&*rows);
}

}  // namespace

void write(const VolumeTransfer& transfer, ByteWriter& out) {
  out.addList(transfer.vectors), out.addList(transfer.visibility);
  out.add(transfer.rays + transfer.rays_kept);
  out.add(transfer.iterations), out.add(transfer.residual), out.add(transfer.row_bytes);
}

bool read(ByteReader& in, VolumeTransfer& transfer) {
  const std::size_t samples = transfer.grid.samples(),
                    visibility = transfer.bands > 3 ? samples * transfer.visibilitySize() : 0;
  return in.readList(transfer.vectors) && transfer.vectors.size() == samples * transfer.vectorSize() &&
         in.readList(transfer.visibility) && transfer.visibility.size() == visibility &&
         in.read(transfer.rays_kept) && in.read(transfer.iterations) && in.read(transfer.residual) &&
         in.read(transfer.row_bytes);
}

std::optional<VolumeTransfer> bakeVolumeTransfer(const Medium& medium, const VolumeSettings& settings,
                                                 const Occluders& occluders, const BakeContext& context) {
  const glm::vec3& w = medium.albedo;
  const bool black = w == glm::vec3(0.0f), grey = w.r == w.g && w.g == w.b;
  VolumeTransfer out{.density = medium.density,
                     .grid = TransferGrid(*medium.density, medium.values, settings.grid),
                     .albedo = w,
                     .order = settings.order,
                     .g = medium.g,
                     .bands = bandsOfPhase(medium.g, settings.order),
                     .full_channels = settings.scatterings == 0 || black ? 0u
                                      : grey                             ? 1u
                                                                         : 3u,
                     .vectors = {},
                     .visibility = {}};
  const auto found = findOrMake(context.part("transfer"), out,
                                [&] { return bakeTransfer(medium, settings, occluders, out, context); });
  if (!found) return std::nullopt;
  if (!*found) dropParts(context, out);
  return out;
}

float marchVolume(const VolumeTransfer& transfer, const glm::vec3& origin, const glm::vec3& direction,
                  float t_max, std::span<float> scattered) {
  constexpr float kLongestStretch = 0.5f;  // relative to the shortest edge of a voxel of the transfer
  constexpr float kNothingLeft = 1e-6f;
  const std::size_t columns = transfer.columns(), outputs = transfer.outputs(),
                    channels = transfer.full_channels;
  assert(scattered.size() == 3 * columns);
  std::fill(scattered.begin(), scattered.end(), 0.0f);
  const TransferGrid& grid = transfer.grid;
  const glm::dvec3 from = grid.gridFromGroup(glm::dvec3(origin)),
                   along = grid.gridDirection(glm::dvec3(direction));
  // These are the shares of each output that continue to the ray's origin: light that arrives from along the
  // ray goes straight on.
  std::vector<float> shares(outputs, 1.0f);
  if (outputs > 1) {
    sh::evaluate(transfer.bands, direction, shares);
    for (std::size_t i = 0; i < outputs; ++i)
      shares[i] *= std::pow(transfer.g, static_cast<float>(sh::bandOf(static_cast<int>(i))));
  }
  const bool dark = grid.samples() == 0 || transfer.albedo == glm::vec3(0.0f);
  double left = 1.0, share = 0.0, moment = 0.0, window = 0.0;
  const auto give = [&] {
    const TransferGrid::Stencil at = grid.stencil(from + moment / share * along, /*level=*/0);
    for (int k = 0; k < at.count; ++k) {
      const float* vector = &transfer.vectors[at.node[static_cast<std::size_t>(k)] * transfer.vectorSize()];
      const auto weight = static_cast<float>(share * at.weight[static_cast<std::size_t>(k)]);
      // This is the block of single scattering if there is no other, else that of all scatterings, in one
      // channel or three.
      for (std::size_t c = 0; c < 3; ++c) {
        const float* block = vector + (channels == 0 ? 0 : channels == 1 ? 1 : 1 + c) * outputs * columns;
        for (std::size_t j = 0; j < outputs; ++j) {
          const float factor = weight * shares[j] * transfer.albedo[static_cast<int>(c)];
          for (std::size_t i = 0; i < columns; ++i)
            scattered[c * columns + i] += factor * block[j * columns + i];
        }
      }
    }
    share = moment = 0.0;
  };
  const auto longest = [&](float) { return kLongestStretch * grid.shortestEdge(); };
  transfer.density->march(origin, direction, t_max, longest, [&](float begin, float end, float depth) {
    if (share > 0.0 && double{end} > window) give();
    if (share == 0.0) window = double{begin} + kLongestStretch * double{grid.shortestEdge()};
    const double gone = -std::expm1(-double{depth}) * left;
    if (!dark) {
      share += gone;
      moment += gone * 0.5 * (double{begin} + double{end});
    }
    left -= gone;
    return left > double{kNothingLeft};
  });
  if (share > 0.0) give();
  return static_cast<float>(left);
}

}  // namespace lambent::baker
