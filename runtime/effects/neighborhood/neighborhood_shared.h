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
  uint pad[3];
};

struct Receiver {
  uint first;  // index into the arrivals
  uint count;
  uint change_word;  // word of the radiance received at its vertices; kNoChange: none
  uint pad;
};
LAMBENT_CONSTANT kNoChange = 0xffffffffu;

// What follows serves receivers with transfer of their own (neighborhood_vertices.comp), and finds where each sample of
// a group stands in its cell's codes (neighborhood_places.comp). Words are 32 bits, counted from the start of an arena
// page.
LAMBENT_CONSTANT kBindVertexBlock = 0u;      // uniform block, an array of VertexReceiver or PlacesCell
LAMBENT_CONSTANT kBindVertexArrivals = 0u;   // TransferRecord (transfer_shared.h)
LAMBENT_CONSTANT kBindVertexTransfers = 1u;  // diffuse's TransferRecord
LAMBENT_CONSTANT kBindVertexPlanes = 2u;     // places of the transfers' planes
LAMBENT_CONSTANT kBindSamplePlaces = 3u;     // per sample of a group: position in its cell's codes | cell of the group << 16
LAMBENT_CONSTANT kBindVertexTransfer = 4u;   // arena page
LAMBENT_CONSTANT kBindVertexRows = 5u;       // arena page
LAMBENT_CONSTANT kBindVertexGeometry = 6u;   // arena page
LAMBENT_CONSTANT kBindVertexChange = 7u;     // 3 floats per vertex: E/pi
LAMBENT_CONSTANT kVertexGroupSize = 64u;
LAMBENT_CONSTANT kRecordsPerDispatch = 256u;  // gl_WorkGroupID.y selects the record; OpenGL 4.5 promises blocks of 16 KiB
LAMBENT_CONSTANT kMaxTurnEntries = 286u;  // 1 + 9 + 25 + ..., for six bands

// Describes one draw, whose cells all lie in one page.
struct VertexReceiver {
  uint first_arrival, arrival_count;
  uint vertex_count;
  uint positions_word;
  uint rows_word, row_entries;
  uint first_place;     // index of the group's first sample in the places
  uint first_transfer;  // index of the TransferRecord of the group's first cell; one per cell
  uint change_word;
  uint pad0, pad1, pad2;
};

struct PlacesCell {
  uint positions_word;
  uint sample_count;
  uint first_place;  // of the cell's first sample
  uint cell;         // index in the group
};

// Matches Arrival, but turns light and not normals: it holds D of group_from_body, band by band and row by row.
struct VertexArrival {
  mat3x4 grid_from_position;
  GridPlace grid;
  float turn[kMaxTurnEntries];
  uint pad[2];
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(GridPlace) == 32 && sizeof(WriteRecord) == 48 && sizeof(Arrival) == 144 && sizeof(Receiver) == 16);
static_assert(offsetof(Arrival, grid) == 96);
static_assert(sizeof(VertexReceiver) == 48 && sizeof(PlacesCell) == 16 && sizeof(VertexArrival) == 1232);
}  // namespace lambent::effects::neighborhood
#endif
