// Shades receivers with transfer of their own, with one invocation per vertex. It computes t_p . dl'(x_p): the change
// of the light at the vertex, in all its bands and turned into the receiver's frame, times the vertex's transfer
// vector, decoded from its codes. The result is E/pi.
#include "neighborhood_shared.h"
#include "neighborhood_eval.glsl"
#include "coded_transfer.glsl"
#include "vertex_rows.glsl"

layout(local_size_x = kVertexGroupSize) in;
layout(std140, binding = kBindVertexBlock) uniform Block { VertexReceiver receivers[kRecordsPerDispatch]; };
layout(std430, binding = kBindVertexArrivals) readonly buffer Arrivals { VertexArrival arrivals[]; };
layout(std430, binding = kBindVertexTransfers) readonly buffer Transfers { TransferRecord transfers[]; };
layout(std430, binding = kBindVertexPlanes) readonly buffer Planes { uint planes[]; };
layout(std430, binding = kBindSamplePlaces) readonly buffer SamplePlaces { uint sample_places[]; };
layout(std430, binding = kBindVertexTransfer) readonly buffer Transfer { uint page[]; };
layout(std430, binding = kBindVertexRows) readonly buffer Rows { uint row_words[]; };
layout(std430, binding = kBindVertexGeometry) readonly buffer Geometry { float geometry[]; };
layout(std430, binding = kBindVertexChange) writeonly buffer Change { float change_out[]; };
layout(binding = kUnitAtlas) uniform sampler3D atlas;

const uint kBandCount = LAMBENT_ORDER, kBandedLight = kBandCount * kBandCount;

vec4 atlasAt(vec3 texel) { return textureLod(atlas, texel / vec3(textureSize(atlas, 0)), 0.0); }
uint codeWordAt(uint word) { return page[word]; }
uint rowWordAt(uint word) { return row_words[word]; }

void addArrival(uint a, vec3 position, inout vec3 change[kBandedLight]) {
  vec3 place = vec4(position, 1.0) * arrivals[a].grid_from_position;
  float share = gridShare(place, arrivals[a].grid);
  if (share == 0.0) return;
  vec3 around[kBandedLight];
  for (uint k = 0u; k < kBandedLight; ++k) around[k] = share * gridOutput(place, arrivals[a].grid, k).rgb;
  uint entry = 0u;
  for (uint l = 0u; l < kBandCount; ++l)
    for (uint i = l * l; i < (l + 1u) * (l + 1u); ++i)
      for (uint j = l * l; j < (l + 1u) * (l + 1u); ++j) change[i] += arrivals[a].turn[entry++] * around[j];
}

// Returns the change times one mean or one axis of a cluster.
vec3 projected(TransferRecord transfer, uint vector, vec3 change[kBandedLight]) {
  uint at = transfer.vectors_word + vector * transfer.vector_size + transfer.first_value;
  uint stride = transfer.channels == 1u ? 0u : transfer.columns;
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < kBandedLight; ++i)
    sum += vec3(uintBitsToFloat(page[at + i]), uintBitsToFloat(page[at + stride + i]),
                uintBitsToFloat(page[at + 2u * stride + i])) *
           change[i];
  return sum;
}

vec3 receivedBySample(VertexReceiver receiver, uint sample_index, vec3 change[kBandedLight]) {
  uint stands = sample_places[receiver.first_place + sample_index];
  TransferRecord transfer = transfers[receiver.first_transfer + (stands >> 16u)];
  uint position = stands & 0xffffu;
  CodedSample at = codedSampleAt(transfer, position);
  vec3 sum = projected(transfer, at.first, change);
  for (uint axis = 0u; axis < at.axes; ++axis) {
    uint vector = at.first + 1u + axis, word = transfer.weights_word + 2u * vector;
    float weight = uintBitsToFloat(page[word]) +
                   uintBitsToFloat(page[word + 1u]) * float(codeOf(planes[transfer.first_plane + axis], position));
    sum += weight * projected(transfer, vector, change);
  }
  return sum;
}

void main() {
  VertexReceiver receiver = receivers[gl_WorkGroupID.y];
  uint vertex = gl_WorkGroupID.x * kVertexGroupSize + gl_LocalInvocationID.x;
  if (vertex >= receiver.vertex_count) return;
  uint at = receiver.positions_word + 3u * vertex;
  vec3 position = vec3(geometry[at], geometry[at + 1u], geometry[at + 2u]);
  vec3 change[kBandedLight];
  for (uint k = 0u; k < kBandedLight; ++k) change[k] = vec3(0.0);
  for (uint a = receiver.first_arrival; a < receiver.first_arrival + receiver.arrival_count; ++a)
    addArrival(a, position, change);
  VertexRows rows = VertexRows(receiver.rows_word, receiver.vertex_count, receiver.row_entries);
  uvec2 row = rowOf(rows, vertex);
  vec3 sum = vec3(0.0);
  float total = 0.0;
  for (uint i = row.x; i < row.y; ++i) {
    RowEntry entry = rowEntryAt(rows, i);
    sum += entry.weight * receivedBySample(receiver, entry.sample_index, change);
    total += entry.weight;
  }
  if (total > 0.0) sum /= total;
  uint out_word = receiver.change_word + 3u * vertex;
  change_out[out_word] = sum.r;
  change_out[out_word + 1u] = sum.g;
  change_out[out_word + 2u] = sum.b;
}
