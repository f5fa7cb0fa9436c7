// Projects texels to spherical harmonics with the weights of sh::cubeWeights, Omega (2 y(centre) - mean y). A
// work group handles a point; an invocation handles four coefficients of every kSlices-th texel. Texels
// without a tile see only sky and are skipped: the results are the bodies' light and the light of the sky
// that they hide,
//   results[2 (point ORDER² + i)]      xyz: sum of w_i * bodies; w: sum of the open shares of texels
//   results[2 (point ORDER² + i) + 1]  xyz: sum of w_i * hidden share * sky; w: sum of w_i * hidden share
// Sums have a fixed order.
#include "capture_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(location = 0) uniform uint first_point;
layout(binding = kUnitValues) uniform samplerBuffer values;
layout(binding = kUnitTexels) uniform usamplerBuffer texels;
layout(binding = kUnitSky) uniform samplerBuffer sky;
layout(binding = kUnitWeights) uniform samplerBuffer weights;
layout(std430, binding = kBindPoints) readonly buffer Points { PointRecord points[]; };
layout(std430, binding = kBindResults) writeonly buffer Results { vec4 results[]; };

const uint kQuads = (ORDER * ORDER + 3) / 4, kSlices = kWorkGroupSize / kQuads;
shared vec4 slice_bodies[kWorkGroupSize * 4u];  // [slice][coefficient]
shared vec4 slice_hidden[kWorkGroupSize * 4u];

void main() {
  uint lane = gl_LocalInvocationIndex, record = first_point + gl_WorkGroupID.x;
  uint slice = lane / kQuads, quad = lane % kQuads;
  PointRecord point = points[record];
  mat4 bodies = mat4(0.0), hidden = mat4(0.0);
  if (slice < kSlices) {
    for (uint k = slice; k < point.texel_count; k += kSlices) {
      int at = int(point.first_texel + k);
      vec4 value = texelFetch(values, at);
      int texel = int(texelFetch(texels, at).y);
      vec4 weight = texelFetch(weights, texel * int(kQuads) + int(quad));
      vec4 light = vec4(value.rgb, 0.0), behind = value.a * vec4(texelFetch(sky, texel).rgb, 1.0);
      bodies += outerProduct(light, weight);
      hidden += outerProduct(behind, weight);
      bodies[0].w += 1.0 - value.a;
    }
    for (uint i = 0u; i < 4u; ++i) {
      slice_bodies[4u * lane + i] = vec4(bodies[i].xyz, bodies[0].w);
      slice_hidden[4u * lane + i] = hidden[i];
    }
  }
  barrier();
  if (lane >= uint(ORDER * ORDER)) return;
  vec4 all_bodies = vec4(0.0), all_hidden = vec4(0.0);
  for (uint s = 0u; s < kSlices; ++s) {
    all_bodies += slice_bodies[4u * kQuads * s + lane];
    all_hidden += slice_hidden[4u * kQuads * s + lane];
  }
  uint at = 2u * (record * uint(ORDER * ORDER) + lane);
  results[at] = all_bodies;
  results[at + 1u] = all_hidden;
}
