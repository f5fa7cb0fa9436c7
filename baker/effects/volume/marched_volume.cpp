#include "baker/effects/volume/marched_volume.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

constexpr float kLongestStretch = 0.5f;  // relative to the shortest edge of a voxel of the transfer
constexpr float kNothingLeft = 1e-6f;

}  // namespace

float MarchedVolume::look(const glm::vec3& origin, const glm::vec3& direction, float t_max,
                          std::span<float> scattered) const {
  const std::size_t columns = transfer_.columns(), outputs = transfer_.outputs(),
                    channels = transfer_.full_channels;
  assert(scattered.size() == 3 * columns);
  std::fill(scattered.begin(), scattered.end(), 0.0f);
  const TransferGrid& grid = transfer_.grid;
  const glm::dvec3 from = grid.gridFromGroup(glm::dvec3(origin)),
                   along = grid.gridDirection(glm::dvec3(direction));
  // These are the shares of each output that continue to the ray's origin: light that arrives from along the
  // ray goes straight on.
  std::vector<float> shares(outputs, 1.0f);
  if (outputs > 1) {
    sh::evaluate(transfer_.bands, direction, shares);
    for (std::size_t i = 0; i < outputs; ++i)
      shares[i] *= std::pow(transfer_.g, static_cast<float>(sh::bandOf(static_cast<int>(i))));
  }
  const bool dark = grid.samples() == 0 || transfer_.albedo == glm::vec3(0.0f);
  double left = 1.0, share = 0.0, moment = 0.0, window = 0.0;
  const auto give = [&] {
    const TransferGrid::Stencil at = grid.stencil(from + moment / share * along, /*level=*/0);
    for (int k = 0; k < at.count; ++k) {
      const float* vector = &transfer_.vectors[at.node[static_cast<std::size_t>(k)] * transfer_.vectorSize()];
      const auto weight = static_cast<float>(share * at.weight[static_cast<std::size_t>(k)]);
      // This is the block of single scattering if there is no other, else that of all scatterings, in one
      // channel or three.
      for (std::size_t c = 0; c < 3; ++c) {
        const float* block = vector + (channels == 0 ? 0 : channels == 1 ? 1 : 1 + c) * outputs * columns;
        for (std::size_t j = 0; j < outputs; ++j) {
          const float factor = weight * shares[j] * transfer_.albedo[static_cast<int>(c)];
          for (std::size_t i = 0; i < columns; ++i)
            scattered[c * columns + i] += factor * block[j * columns + i];
        }
      }
    }
    share = moment = 0.0;
  };
  const auto longest = [&](float) { return kLongestStretch * grid.shortestEdge(); };
  transfer_.density->march(origin, direction, t_max, longest, [&](float begin, float end, float depth) {
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
