// This file is shared by C++ and GLSL. It serves receivers with transfer of their own (neighborhood_vertices.comp),
// and finds where each sample of a group stands in its cell's codes (neighborhood_places.comp). Words are 32 bits,
// counted from the start of an arena page.
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
static_assert(sizeof(VertexReceiver) == 48 && sizeof(PlacesCell) == 16 && sizeof(VertexArrival) == 1232);
}  // namespace lambent::effects::neighborhood
#endif
