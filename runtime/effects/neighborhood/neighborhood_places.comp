// Inverts a cell's list of positions, so that each sample of the group finds its code. One invocation serves one
// position.
#include "neighborhood_shared.h"

layout(local_size_x = kVertexGroupSize) in;
layout(std140, binding = kBindVertexBlock) uniform Block { PlacesCell cells[kRecordsPerDispatch]; };
layout(std430, binding = kBindVertexTransfer) readonly buffer Transfer { uint page[]; };
layout(std430, binding = kBindSamplePlaces) writeonly buffer SamplePlaces { uint sample_places[]; };

void main() {
  PlacesCell cell = cells[gl_WorkGroupID.y];
  uint position = gl_WorkGroupID.x * kVertexGroupSize + gl_LocalInvocationID.x;
  if (position >= cell.sample_count) return;
  sample_places[cell.first_place + (page[cell.positions_word + position] & 0xffffu)] = position | cell.cell << 16u;
}
