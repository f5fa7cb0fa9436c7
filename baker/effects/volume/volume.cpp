#include "baker/effects/volume/volume.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "baker/effects/volume/scattering.hpp"
#include "baker/jobs/stage.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// Removes the checkpoints, once all parts are complete.
void dropParts(const BakeContext& context, const VolumeTransfer& transfer) {
  if (!context.keeps()) return;
  const std::size_t samples = transfer.grid.samples();
  dropStage(context.part("light"), samples, kSamplesPerLight);
  dropStage(context.part("rows"), samples, kSamplesPerChunk);
  if (transfer.bands == 1) dropWithinVoxels(context.part("within voxels"), *transfer.density, transfer.grid);
  for (std::size_t block = 0; block < transfer.columns(); block += kBlockColumns)
    for (std::uint32_t channel = 0; channel < transfer.full_channels; ++channel)
      dropValue(context.part("block", block, channel).part("solved"));
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
  const auto found = findOrMake(context.part("transfer"), out, [&] {
    out.rays_kept = 0, out.visibility.clear();
    out.vectors.assign(out.grid.samples() * out.vectorSize(), 0.0f);
    const auto bake = out.bands > 1 ? bakePhasedTransfer : bakeIsotropicTransfer;
    return out.grid.samples() == 0 || bake(medium, settings, occluders, out, context);
  });
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
