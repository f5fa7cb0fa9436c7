// One text for C++ and GLSL: receivers with transfer of their own (neighborhood_vertices.comp), and where in a cell's
// codes each sample of a group stands (neighborhood_places.comp). Words are 32 bits from the start of an arena page.
#include "neighborhood_shared.h"
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

namespace lambent::effects::neighborhood {
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindVertexBlock = 0u;      // uniform block of so many VertexReceivers, or PlacesCells
LAMBENT_CONSTANT kBindVertexArrivals = 0u;   // VertexArrival
LAMBENT_CONSTANT kBindVertexTransfers = 1u;  // diffuse's TransferRecord
LAMBENT_CONSTANT kBindVertexPlanes = 2u;     // what these call places: where their planes lie
LAMBENT_CONSTANT kBindSamplePlaces = 3u;     // per sample of a group: position in its cell's codes | cell of the group << 16
LAMBENT_CONSTANT kBindVertexTransfer = 4u;   // arena page
LAMBENT_CONSTANT kBindVertexRows = 5u;       // arena page
LAMBENT_CONSTANT kBindVertexGeometry = 6u;   // arena page
LAMBENT_CONSTANT kBindVertexChange = 7u;     // 3 floats per vertex: E/pi
LAMBENT_CONSTANT kVertexGroupSize = 64u;
LAMBENT_CONSTANT kRecordsPerDispatch = 256u;  // gl_WorkGroupID.y says which; OpenGL 4.5 promises blocks of 16 KiB
LAMBENT_CONSTANT kMaxTurnEntries = 286u;  // 1 + 9 + 25 + ..., six bands

// One draw, whose cells all lie in one page.
struct VertexReceiver {
  uint first_arrival, arrival_count;
  uint vertex_count;
  uint positions_word;
  uint rows_word, row_entries;
  uint first_place;     // of the group's samples
  uint first_transfer;  // of the group's cells: index of the TransferRecord, one a cell
  uint change_word;
  uint pad0, pad1, pad2;
};

struct PlacesCell {
  uint positions_word;
  uint sample_count;
  uint first_place;  // of the cell's first sample
  uint cell;         // of the group
};

// As Arrival, with light turned rather than normals: D, band by band, row by row, of group_from_body.
struct VertexArrival {
  mat3x4 grid_from_position;
  GridPlace grid;
  float turn[kMaxTurnEntries];
  uint pad[2];
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(VertexReceiver) == 48 && sizeof(PlacesCell) == 16 && sizeof(VertexArrival) == 1232);
}  // namespace lambent::effects::neighborhood
#endif
