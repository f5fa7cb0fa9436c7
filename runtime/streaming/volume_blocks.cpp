#include "runtime/streaming/volume_blocks.hpp"

#include <algorithm>
#include <cassert>

namespace lambent::streaming {

namespace {

// The blocks that a voxel contributes to: its own, and the adjacent one if it lies at the border.
struct Blocks {
  std::uint32_t first, last;
};
Blocks blocksAt(std::uint32_t voxel, std::uint32_t count) {
  const std::uint32_t own = voxel / kVolumeBlock, place = voxel % kVolumeBlock;
  return {place == 0 && own > 0 ? own - 1 : own,
          place == kVolumeBlock - 1 ? std::min(own + 1, count - 1) : own};
}

}  // namespace

std::vector<float> blockMaxima(std::span<const std::byte> codes, std::uint32_t bits, const glm::uvec3& size) {
  const std::size_t width = bits / 8;
  assert(codes.size() == width * size.x * size.y * size.z);
  const glm::uvec3 count = blocksOf(size);
  std::vector<std::uint32_t> maxima(std::size_t{count.x} * count.y * count.z, 0);
  std::size_t at = 0;
  for (std::uint32_t z = 0; z < size.z; ++z)
    for (std::uint32_t y = 0; y < size.y; ++y)
      for (std::uint32_t x = 0; x < size.x; ++x, at += width) {
        auto code = std::to_integer<std::uint32_t>(codes[at]);
        if (width == 2) code |= std::to_integer<std::uint32_t>(codes[at + 1]) << 8;
        if (code == 0) continue;
        const Blocks in_x = blocksAt(x, count.x), in_y = blocksAt(y, count.y), in_z = blocksAt(z, count.z);
        for (std::uint32_t k = in_z.first; k <= in_z.last; ++k)
          for (std::uint32_t j = in_y.first; j <= in_y.last; ++j)
            for (std::uint32_t i = in_x.first; i <= in_x.last; ++i) {
              std::uint32_t& most = maxima[i + std::size_t{count.x} * (j + std::size_t{count.y} * k)];
              most = std::max(most, code);
            }
      }
  const float largest = bits == 16 ? 65535.0f : 255.0f;
  std::vector<float> shares(maxima.size());
  std::transform(maxima.begin(), maxima.end(), shares.begin(),
                 [&](std::uint32_t code) { return static_cast<float>(code) / largest; });
  return shares;
}

}  // namespace lambent::streaming
