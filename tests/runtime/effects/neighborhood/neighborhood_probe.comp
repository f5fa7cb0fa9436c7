// Evaluates what receivers get from a grid, one query per invocation. The first result has the share in w and E/pi in
// RGB; the second is the last output.
#include "neighborhood_eval.glsl"

layout(local_size_x = 64) in;
struct Query {
  vec4 place;
  vec4 normal;
};
layout(std430, binding = 0) readonly buffer Queries { Query queries[]; };
layout(std430, binding = 1) readonly buffer Grids { GridPlace grids[]; };
layout(std430, binding = 2) writeonly buffer Results { vec4 results[]; };
layout(binding = kUnitAtlas) uniform sampler3D atlas;

vec4 atlasAt(vec3 texel) { return textureLod(atlas, texel / vec3(textureSize(atlas, 0)), 0.0); }

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= queries.length()) return;
  GridPlace grid = grids[0];
  results[2u * i] = vec4(gridIrradiance(queries[i].place.xyz, grid, queries[i].normal.xyz),
                         gridShare(queries[i].place.xyz, grid));
  results[2u * i + 1u] = gridOutput(queries[i].place.xyz, grid, grid.outputs - 1u);
}
