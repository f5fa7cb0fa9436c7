// This file is shared by C++ and GLSL. It says how the change of the light around bodies is laid out in the atlas, a
// 3D texture, and what is bound to write the atlas and to receive from it.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/mat3x4.hpp>

namespace lambent::effects::neighborhood {
using uint = std::uint32_t;
using glm::mat3x4;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

// These are bindings of neighborhood_write.comp, which writes the atlas.
LAMBENT_CONSTANT kWriteGroupSize = 64u;
LAMBENT_CONSTANT kWriteGroupsX = 65535u;  // longer lists fold into y
LAMBENT_CONSTANT kBindWriteWork = 0u;     // WorkItem per work group
LAMBENT_CONSTANT kBindWrites = 1u;        // WriteRecord
LAMBENT_CONSTANT kBindWriteSamples = 2u;  // arena page: shaded points, a vec4 per output
LAMBENT_CONSTANT kImageAtlas = 0u;

// These are bindings for receiving. They are storage blocks of the surface pass, which uses the lower bindings itself
// (surface_shared.h, local_shared.h).
LAMBENT_CONSTANT kBindReceivers = 6u;  // Receiver per draw of the residency
LAMBENT_CONSTANT kBindArrivals = 7u;   // Arrival
LAMBENT_CONSTANT kUnitAtlas = 11u;     // texture unit

// Says where a grid lies. Each output is a slab of size_x * size_y * size_z texels, one texel per point. Slab o has
// its first texel at (0, first_y, first_z) + (0, size_y * (o / slabs_per_column), size_z * (o % slabs_per_column)).
struct GridPlace {
  uint size_x, size_y, size_z;
  uint outputs;
  uint first_y, first_z;  // first_x is 0
  uint slabs_per_column;
  float scale;  // a stored value times this is the change of the light
};

// Describes the points of one cell of a grid.
struct WriteRecord {
  GridPlace grid;
  uint first_output;  // vec4 index into the samples page
  uint first_point;   // index in the grid
  uint point_count;
  uint pad;
};

// Describes what one draw receives from one grid. The matrices are rows of affine maps: from the position that the
// surface pass has per pixel to points of the grid, and from directions of the receiver's group to the frame of the
// body.
struct Arrival {
  mat3x4 grid_from_position;
  mat3x4 body_from_group;
  GridPlace grid;
  uint whole;  // 1: the change counts for all light, key lights too, because this body has no shadow map for them
  uint pad0, pad1, pad2;
};

struct Receiver {
  uint first;  // index into the arrivals
  uint count;
  uint change_word;  // word of the radiance received at its vertices; kNoChange: none
  uint pad;
};
LAMBENT_CONSTANT kNoChange = 0xffffffffu;

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(GridPlace) == 32 && sizeof(WriteRecord) == 48 && sizeof(Arrival) == 144 && sizeof(Receiver) == 16);
static_assert(offsetof(Arrival, grid) == 96);
}  // namespace lambent::effects::neighborhood
#endif
