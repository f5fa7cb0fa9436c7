// Holds what glossy surfaces have in common: it gathers l' at the pixel from the samples of the triangle's corners.
// l' is not passed as varyings, because OpenGL 4.5 promises too few.
#include "mapped_normal.glsl"
#include "surface_light.glsl"

layout(std430, binding = kBindRows) readonly buffer Rows { uint row_words[]; };
layout(std430, binding = kBindSamples) readonly buffer Samples { vec4 samples[]; };
layout(location = 6) in vec3 position_mesh;
layout(location = 7) in vec4 looks_at_reflection;
layout(location = 8) in vec4 looks_at_lobes;

#include "reflection_inputs.glsl"

// The number of bands that count. Higher ones are treated as 0.
#ifndef LAMBENT_USED_BANDS
#define LAMBENT_USED_BANDS LAMBENT_BANDS
#endif
const int kUsedCoefficients = LAMBENT_USED_BANDS * LAMBENT_USED_BANDS;

const bool kHighlights = true;

#include "vertex_rows.glsl"
uint rowWordAt(uint word) { return row_words[word]; }

#include "gathered_light.glsl"

// Gathers l' from the triangle's corners. A corner without samples leaves the pixel to the other corners.
void gatherLight(out vec4 light[kCoefficients]) {
  uvec3 corners = triangleCorners();
  vec3 weights = weightsOf(corners, position_mesh);
  VertexRows rows = VertexRows(draws[draw_of].glossy.rows_word, draws[draw_of].glossy.vertex_count, draws[draw_of].glossy.row_entries);
  float total = 0.0;
  for (int k = 0; k < kCoefficients; ++k) light[k] = vec4(0.0);
  for (int corner = 0; corner < 3; ++corner) {
    uvec2 row = rowOf(rows, corners[corner]);
    for (uint i = row.x; i < row.y; ++i) {
      RowEntry entry = rowEntryAt(rows, i);
      float weight = weights[corner] * entry.weight;
      uint at = draws[draw_of].glossy.first_output + uint(kCoefficients) * (entry.sample_index - draws[draw_of].glossy.first_sample);
      total += weight;
      for (int k = 0; k < kUsedCoefficients; ++k) light[k] += weight * samples[at + uint(k)];
    }
  }
  float scale = total > 0.0 ? 1.0 / total : 0.0;
  for (int k = 0; k < kCoefficients; ++k) light[k] *= scale;
  addGatheredLight(corners, weights, light);
}
