// Stage c for texels: gathers the sample of each texel of one draw, with one invocation per texel. It writes linear
// E/pi, not clamped, with the share that is shaded in alpha.
#include "diffuse_shared.h"

layout(local_size_x = kTexelGroupSize, local_size_y = kTexelGroupSize) in;
layout(std430, binding = kBindDraws) readonly buffer Draws { DrawRecord draws[]; };
layout(std430, binding = kBindRows) readonly buffer Rows { uint row_words[]; };
layout(std430, binding = kBindSamples) readonly buffer Samples { vec4 samples[]; };
layout(rgba16f, binding = 0) writeonly uniform image2D irradiance;
layout(location = 0) uniform uint draw_of;

#define LAMBENT_STAGE_TEXELS
#include "diffuse_eval.glsl"

vec3 lightAt(uint index) { return vec3(0.0); }  // texels need no light but that of their samples
vec4 sampleAt(uint index) { return samples[index]; }
uint rowWordAt(uint word) { return row_words[word]; }

void main() {
  DrawRecord draw = draws[draw_of];
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= draw.texels || at.y >= draw.texels) return;
  imageStore(irradiance, ivec2(at), texelRadiance(draw, at.x + draw.texels * at.y));
}
