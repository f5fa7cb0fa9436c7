// Tells how the materials of a bundle read its images, as colour or as linear numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/bundle/description.hpp"

namespace lambent::streaming {

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

}  // namespace lambent::streaming
