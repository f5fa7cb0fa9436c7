// Holds what glossy surfaces have in common: it gathers l' at the pixel from the samples of the triangle's corners,
// finds the direction to the eye, and includes the kernel that turns both into reflected light (glossy_kernel.glsl).
// l' is not passed as varyings, because OpenGL 4.5 promises too few.
#include "mapped_normal.glsl"
#include "surface_light.glsl"

layout(std140, binding = kBindView) uniform ViewBlock {
  mat4 view_from_world;
  mat4 clip_from_view;
  vec4 eye;  // world; if w is 0, the direction towards the eye of an orthographic camera
};
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
layout(std430, binding = kBindRows) readonly buffer Rows { uint row_words[]; };
layout(std430, binding = kBindSamples) readonly buffer Samples { vec4 samples[]; };
layout(binding = kUnitMetallicRoughness) uniform sampler2D metallic_roughness_texture;
layout(binding = kUnitSpecular) uniform sampler2D specular_texture;
layout(binding = kUnitSpecularColor) uniform sampler2D specular_color_texture;
layout(binding = kUnitAnisotropy) uniform sampler2D anisotropy_texture;
layout(binding = kUnitBrdf) uniform sampler2DArray brdf_table;
layout(location = 6) in vec3 position_mesh;
layout(location = 7) in vec4 looks_at_reflection;
layout(location = 8) in vec4 looks_at_lobes;

#include "glossy_kernel.glsl"

// The number of bands that count. Higher ones are treated as 0.
#ifndef LAMBENT_USED_BANDS
#define LAMBENT_USED_BANDS LAMBENT_BANDS
#endif
const int kUsedCoefficients = LAMBENT_USED_BANDS * LAMBENT_USED_BANDS;

uvec2 brdfNodes() { return uvec2(textureSize(brdf_table, 0).xy); }
vec4 brdfTexel(vec2 place, uint layer) {
  return textureLod(brdf_table, vec3((place + 0.5) / vec2(textureSize(brdf_table, 0).xy), float(layer)), 0.0);
}

vec3 cornerPosition(uint corner) {
  uint at = draws[draw_of].positions_word + 3u * corner;
  return vec3(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u]), uintBitsToFloat(geometry[at + 2u]));
}

const bool kHighlights = true;

#include "vertex_rows.glsl"
uint rowWordAt(uint word) { return row_words[word]; }

#include "gathered_light.glsl"

// Gathers l' from the triangle's corners. A corner without samples leaves the pixel to the other corners.
void gatherLight(out vec4 light[kCoefficients]) {
  uint first = draws[draw_of].glossy.indices_word + 3u * uint(gl_PrimitiveID);
  uvec3 corners = uvec3(geometry[first], geometry[first + 1u], geometry[first + 2u]);
  vec3 weights = cornerWeights(position_mesh, cornerPosition(corners.x), cornerPosition(corners.y),
                               cornerPosition(corners.z));
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

// Returns the unit direction towards the eye, in the group's frame.
vec3 towardsEye() {
  vec3 position_ws = (draws[draw_of].world_from_mesh * vec4(position_mesh, 1.0)).xyz;
  return unit(mat3(draws[draw_of].glossy.group_from_world) * (eye.xyz - eye.w * position_ws));
}
