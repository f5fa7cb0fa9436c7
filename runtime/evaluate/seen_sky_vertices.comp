// Gathers what a vertex sees of the sky from its row of samples, with one invocation per vertex. What is not resident
// counts as open, as it does where light is shaded.
#include "transfer_shared.h"
#include "seen_sky_kernels.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
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
