// Adds scattered light to the first light of a volume: solves for each channel and each block of columns.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "baker/effects/volume/gmres.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/volume_transfer.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

// `make(albedo, context)` returns a linear system with solve() and repeat(), whose rows are the outputs of
// samples; the key of its context is that of the block. The first light is the first block of each of
// out.vectors, and the channels follow it. Returns false if stopped.
template <typename Make>
bool scatterLight(const Make& make, const VolumeSettings& settings, VolumeTransfer& out,
                  const BakeContext& context) {
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
      const double albedo = std::min(double{out.albedo[static_cast<int>(channel)]}, kLargestAlbedo);
      const BakeContext block_context = context.part("block", begin, channel);
      auto system = make(albedo);
      SolvedBlock solved{{}, result};
      const auto found = findOrMake(block_context.part("solved"), solved, [&] {
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

}  // namespace lambent::baker
