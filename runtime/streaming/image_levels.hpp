// Images as their mip levels: which of them lie on the GPU, what they take there, and how a coarser one is
// made of the texels of the file. An image that is wanted from level l on is decoded whole, brought down to
// that level here and given to the GPU as if it were all there is; the GPU makes the coarser levels, as it
// does of whole images. No GL; safe from any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/streaming/image_decode.hpp"

namespace lambent::streaming {

// As OpenGL rounds.
ImageSize sizeAt(const ImageSize& size, std::uint32_t level);
// Down to a single texel.
std::uint32_t levelCount(const ImageSize& size);
// A texture of this size with all its mip levels.
std::uint64_t textureBytes(const ImageSize& size);

// The finest level that comes with the surfaces, however little room there is: at most so many texels a side.
inline constexpr std::uint32_t kCoarseSide = 64;
std::uint32_t coarseLevel(const ImageSize& size);

// Means over the area of each texel, of four channels; `color`: of the light that sRGB codes of the first
// three stand for.
std::vector<std::uint8_t> shrink(std::span<const std::uint8_t> rgba, const ImageSize& size,
                                 std::uint32_t level, bool color);

}  // namespace lambent::streaming
