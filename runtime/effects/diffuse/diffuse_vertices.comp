// Stage c gathers a vertex's row of samples, with one invocation per vertex of the dirty draws. It writes linear
// E/pi, not clamped, and the luminance of what comes straight from lights that are shaded per pixel; or with
// LAMBENT_OUTPUTS 9 the transferred light from which a normal map is shaded.
#include "diffuse_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindLights) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = kBindDraws) readonly buffer Draws { DrawRecord draws[]; };
layout(std430, binding = kBindRows) readonly buffer Rows { uint row_words[]; };
layout(std430, binding = kBindGeometry) readonly buffer Geometry { float geometry[]; };
layout(std430, binding = kBindRadiance) writeonly buffer Radiance { float radiance_out[]; };
layout(std430, binding = kBindSamples) readonly buffer Samples { vec4 samples[]; };

#define LAMBENT_STAGE_VERTICES
#include "diffuse_eval.glsl"

vec3 lightAt(uint index) { return lights[index].rgb; }
vec4 sampleAt(uint index) { return samples[index]; }
uint rowWordAt(uint word) { return row_words[word]; }

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  DrawRecord draw = draws[work[index].record];
  uint vertex = work[index].first + gl_LocalInvocationID.x;
  if (vertex >= draw.vertex_count) return;
#if LAMBENT_OUTPUTS == 1
  uint at = draw.normals_word + 3u * vertex;
  vec3 normal_mesh = vec3(geometry[at], geometry[at + 1u], geometry[at + 2u]);
  mat3 group_from_mesh;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) group_from_mesh[c][r] = draw.group_from_mesh_normal[4 * c + r];
  vec3 normal = normalize(group_from_mesh * normal_mesh);
#ifdef LAMBENT_ORDER
  vec4 light = vertexRadiance(draw, vertex, normal, LAMBENT_ORDER);
#else
  vec4 light = vertexRadiance(draw, vertex, normal, int(draw.order));
#endif
  uint out_word = draw.radiance_word + 4u * vertex;
  for (uint k = 0u; k < 4u; ++k) radiance_out[out_word + k] = light[k];
#else
  vec3 light[kMappedOutputs];
  vertexLight(draw, vertex, light);
  uint out_word = draw.radiance_word + 3u * LAMBENT_OUTPUTS * vertex;
  for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) {
    radiance_out[out_word + 3u * j] = light[j].r;
    radiance_out[out_word + 3u * j + 1u] = light[j].g;
    radiance_out[out_word + 3u * j + 2u] = light[j].b;
  }
#endif
}
