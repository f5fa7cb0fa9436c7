// Where the grids of all bodies lie in one 3D texture: each output of a grid is a slab of as many texels as
// the grid has points, slabs stack along z and, where that ends, go on in a column beside. One texture for
// all, so that draws that receive from different bodies still share a multi-draw. No GL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/effects/neighborhood/neighborhood_shared.h"

namespace lambent::effects::neighborhood {

struct GridShape {
  glm::uvec3 size{1};
  std::uint32_t outputs = 9;
};

struct AtlasLayout {
  glm::uvec3 size{0};             // texels; 0: nothing was placed
  std::vector<GridPlace> places;  // one per shape; outputs 0: there was no room
};

// max_side: of a 3D texture on this device; OpenGL 4.5 promises 2048. Large grids first.
AtlasLayout layOutAtlas(std::span<const GridShape> shapes, std::uint32_t max_side);

}  // namespace lambent::effects::neighborhood
