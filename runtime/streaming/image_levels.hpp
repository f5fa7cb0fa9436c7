// Computes sizes and texels of mip levels. An image that is needed from level l on is decoded whole, reduced
// to that level here and uploaded as a texture of its own. The GPU makes the coarser levels. Nothing here
// uses GL, and the functions may be called from any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/streaming/image_decode.hpp"

namespace lambent::streaming {

// Returns the size of a mip level, rounded as in OpenGL.
ImageSize sizeAt(const ImageSize& size, std::uint32_t level);
// Returns the number of mip levels down to a single texel.
std::uint32_t levelCount(const ImageSize& size);
// Returns the size in bytes of a texture with all its mip levels.
std::uint64_t textureBytes(const ImageSize& size);

// The finest level that is loaded with the surfaces, however little memory there is, has at most kCoarseSide
// texels per side.
inline constexpr std::uint32_t kCoarseSide = 64;
std::uint32_t coarseLevel(const ImageSize& size);

// Reduces an image to a mip level by averaging over the area of each texel. If `color` is true, the first
// three channels are sRGB codes and their linear values are averaged.
std::vector<std::uint8_t> shrink(std::span<const std::uint8_t> rgba, const ImageSize& size,
                                 std::uint32_t level, bool color);

}  // namespace lambent::streaming
