// How the materials of a bundle read its images: which of them lie on the GPU as colour, which as plain
// numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/bundle/description.hpp"

namespace lambent::streaming {

struct ImageUse {
  bool color = false;   // decoded from sRGB where it is looked up
  bool linear = false;  // normals, roughness and the like

  unsigned copies() const { return (color ? 1u : 0u) + (linear ? 1u : 0u); }
};

// By image. Textures that only glossy surfaces read count where a glossy draw has the material. What no
// material names may yet be asked for: as colour, the usual.
std::vector<ImageUse> imageUses(const bundle::Description& description);

// That the material names, none twice; -1: none.
std::vector<std::uint32_t> imagesOf(const bundle::Description& description, std::int32_t material);

}  // namespace lambent::streaming
