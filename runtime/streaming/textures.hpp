// Textures of a bundle: decoding of images, their mip levels, how materials read them, and tables of b(v).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::streaming {

// Decodes texture images (PNG or JPEG) of a bundle. Texels have four channels of 8 bits, with row 0 at the
// top, and colours stay sRGB-coded. Alpha is 1 if the file has none. Errors name `subject`. The functions may
// be called from any thread.

// Largest width and height in texels, which OpenGL 4.5 drivers support. Larger images are rejected before any
// memory is allocated.
inline constexpr std::uint32_t kMaxImageSide = 16384;

struct ImageSize {
  std::uint32_t width = 0, height = 0;
  std::size_t rgbaBytes() const { return std::size_t{4} * width * height; }
};

// Reads the size from the header alone. Fails if the file is no PNG or JPEG, is empty, or has a side over
// kMaxImageSide.
Result<ImageSize> imageSize(std::span<const std::byte> file, const std::string& subject);

// Fails as imageSize does, and if the data are damaged.
Result<std::vector<std::uint8_t>> decodeRgba(std::span<const std::byte> file, const std::string& subject);

// Computes sizes and texels of mip levels. An image that is needed from level l on is decoded whole, reduced
// to that level here and uploaded as a texture of its own. The GPU makes the coarser levels. These
// functions do not use GL and may be called from any thread.

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

// Tells how the materials of a bundle read its images, as colour or as linear numbers.
struct ImageUse {
  bool color = false;   // true if some texture decodes it from sRGB
  bool linear = false;  // true if some texture reads it as numbers, such as normals or roughness

  unsigned copies() const { return (color ? 1u : 0u) + (linear ? 1u : 0u); }
};

// Returns the use of each image. Textures that only glossy surfaces read count if a glossy draw has the
// material. An image that no material reads counts as colour.
std::vector<ImageUse> imageUses(const bundle::Description& description);

// Returns the images that a material reads, each once. Material -1 has none.
std::vector<std::uint32_t> imagesOf(const bundle::Description& description, std::int32_t material);

// Packs a table of b(v) into a texture for shaders. The texture array holds the zonal weights of every node
// (runtime/sh/zonal.hpp) as floats, four per texel. The hardware interpolates between texels of a
// layer; glossy_kernel.glsl reads them. The axes of the texture are:
//   x:     u of the view's angle (bundle::angleAxis)
//   y:     roughness if isotropic, else azimuth
//   layer: texel t of a node if isotropic, else (strength * roughnesses + roughness) * texels + t, where the
//          shader interpolates between strengths and between roughnesses
// Weight p of lobe a is component 2p + a of the node if there are two lobes, and 4p + a if there are three.
struct BrdfTexels {
  std::uint32_t width = 0, height = 0, layers = 0;
  std::uint32_t per_node = 0;     // texels per node
  std::vector<glm::vec4> values;  // [layer][y][x]

  std::uint64_t bytes() const { return sizeof(glm::vec4) * values.size(); }
};
BrdfTexels packBrdf(const bundle::BrdfTable& table);

// Holds a table on the GPU.
struct BrdfTexture {
  gpu::Texture texture;  // empty until it is loaded
  std::uint32_t order = 0, roughnesses = 1, strengths = 1;
};
// Fails, naming `subject`, if the texture needs more layers than the device supports.
Result<BrdfTexture> makeBrdfTexture(const bundle::BrdfTable& table, const BrdfTexels& texels,
                                    const std::string& subject);

}  // namespace lambent::streaming
