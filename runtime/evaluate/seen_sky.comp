// The kernels of seen_sky.hpp: LAMBENT_SAMPLES decodes samples, the other one gathers them at vertices.
#include "transfer_shared.h"
#include "seen_sky_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };

#ifdef LAMBENT_SAMPLES
// Decodes what samples see of the sky, with one invocation per position of a cell. LAMBENT_OUTPUTS is 1, or 9 for
// normal-mapped samples, whose outputs become one at the normal of a vertex.
layout(std430, binding = kBindSeenCells) readonly buffer Cells { SeenCell cells[]; };
layout(std430, binding = kBindTransfers) readonly buffer Transfers { TransferRecord transfers[]; };
layout(std430, binding = kBindPlaces) readonly buffer Places { uint places[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { uint page[]; };
layout(std430, binding = kBindSeenSamples) writeonly buffer Seen { uint seen[]; };

#include "coded_transfer.glsl"

uint codeWordAt(uint word) { return page[word]; }
float floatAt(uint word) { return uintBitsToFloat(page[word]); }

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  SeenCell cell = cells[work[index].record];
  TransferRecord transfer = transfers[cell.transfer];
  uint position = work[index].first + gl_LocalInvocationID.x;
  if (position >= transfer.sample_count) return;
  CodedSample at = codedSampleAt(transfer, position);
  uint known = min(transfer.order * transfer.order, kSeenCoefficients);
  float share = 1.0 / float(transfer.channels);
  uint out_word = cell.first_word + kSeenWords * LAMBENT_OUTPUTS * at.sample_index;
  for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) {
    float sums[2u * kSeenWords];
    for (uint k = 0u; k < 2u * kSeenWords; ++k) sums[k] = 0.0;
    for (uint c = 0u; c < transfer.channels; ++c) {
      uint word = transfer.vectors_word + transfer.vector_size * at.first + transfer.first_value +
                  (c * transfer.outputs + j) * transfer.columns;
      for (uint k = 0u; k < known; ++k) sums[k] += share * floatAt(word + k);
      for (uint axis = 0u; axis < at.axes; ++axis) {
        word += transfer.vector_size;
        uint weights = transfer.weights_word + 2u * (at.first + axis + 1u);
        float code = float(codeOf(places[transfer.first_plane + axis], position));
        float weight = share * (floatAt(weights) + floatAt(weights + 1u) * code);
        for (uint k = 0u; k < known; ++k) sums[k] += weight * floatAt(word + k);
      }
    }
    sums[2u * kSeenWords - 1u] = 1.0;
    for (uint i = 0u; i < kSeenWords; ++i)
      seen[out_word + kSeenWords * j + i] = packHalf2x16(vec2(sums[2u * i], sums[2u * i + 1u]));
  }
}
#else
// Gathers what a vertex sees of the sky from its row of samples, with one invocation per vertex. What is not resident
// counts as open, as it does where light is shaded.
layout(std430, binding = kBindSeenDraws) readonly buffer Draws { SeenDraw draws[]; };
layout(std430, binding = kBindSeenRows) readonly buffer Rows { uint row_words[]; };
layout(std430, binding = kBindSeenGeometry) readonly buffer Geometry { float geometry[]; };
layout(std430, binding = kBindSeenVertices) writeonly buffer Vertices { uint vertices[]; };
layout(std430, binding = kBindSeenSamples) readonly buffer Seen { uint seen[]; };

#include "vertex_rows.glsl"
#include "diffuse_light.glsl"
#include "seen_sky.glsl"

uint rowWordAt(uint word) { return row_words[word]; }

// Returns a coefficient of an open surface, A_l/pi y_k(n).
float openCoefficient(uint k, vec3 normal) {
  const float kWeights[5] = float[5](1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0);
  float only[kSeenCoefficients];
  for (uint i = 0u; i < kSeenCoefficients; ++i) only[i] = i == k ? 1.0 : 0.0;
  float bands[kSeenBands];
  seenBands(only, normal, bands);
  uint l = k < 1u ? 0u : k < 4u ? 1u : k < 9u ? 2u : k < 16u ? 3u : 4u;
  return kWeights[l] * bands[l];
}

// Returns two coefficients of a sample at a normal.
vec2 pairOf(uint word, uint pair, vec3 normal) {
#if LAMBENT_OUTPUTS == 1
  return unpackHalf2x16(seen[word + pair]);
#else
  vec3 outputs[9];
  for (uint j = 0u; j < 9u; ++j) outputs[j] = vec3(unpackHalf2x16(seen[word + kSeenWords * j + pair]), 0.0);
  return diffuseLight(outputs, normal).xy;
#endif
}

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  SeenDraw draw = draws[work[index].record];
  uint vertex = work[index].first + gl_LocalInvocationID.x;
  if (vertex >= draw.vertex_count) return;
  uint at = draw.normals_word + 3u * vertex;
  float m[12] = draw.group_from_mesh_normal;
  vec3 normal = normalize(mat3(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]) *
                          vec3(geometry[at], geometry[at + 1u], geometry[at + 2u]));
  vec2 sums[kSeenWords];
  for (uint i = 0u; i < kSeenWords; ++i) sums[i] = vec2(0.0);
  VertexRows rows = VertexRows(draw.rows_word, draw.vertex_count, draw.row_entries);
  uvec2 row = rowOf(rows, vertex);
  float known = 0.0, total = 0.0;
  for (uint e = row.x; e < row.y; ++e) {
    RowEntry entry = rowEntryAt(rows, e);
    uint word = draw.samples_word + kSeenWords * LAMBENT_OUTPUTS * (entry.sample_index - draw.first_sample);
    total += entry.weight;
    if (unpackHalf2x16(seen[word + kSeenWords - 1u]).y == 0.0) continue;
    known += entry.weight;
    for (uint i = 0u; i < kSeenWords; ++i) sums[i] += entry.weight * pairOf(word, i, normal);
  }
  float scale = total > 0.0 ? 1.0 / total : 1.0, open = total > 0.0 ? 1.0 - known / total : 1.0;
  for (uint i = 0u; i < kSeenWords; ++i) {
    vec2 pair = scale * sums[i];
    if (open > 1e-6) pair += open * vec2(openCoefficient(2u * i, normal), openCoefficient(2u * i + 1u, normal));
    vertices[draw.seen_word + kSeenWords * vertex + i] = packHalf2x16(pair);
  }
}
#endif
