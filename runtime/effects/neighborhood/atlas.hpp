// Lays out the grids of all bodies in one 3D texture. Each output of a grid is a slab with one texel per grid
// point; slabs are stacked along z and continue in a neighbouring column when that is full. There is one
// texture for all, so that draws that receive from different bodies share a multi-draw. No GL.
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
  glm::uvec3 size{0};             // in texels; 0: nothing was placed
  std::vector<GridPlace> places;  // one per shape; outputs is 0 if there was no room
};

// Places large grids first. `max_side` is the limit of a 3D texture on this device; OpenGL 4.5 guarantees
// 2048.
AtlasLayout layOutAtlas(std::span<const GridShape> shapes, std::uint32_t max_side);

}  // namespace lambent::effects::neighborhood
