// From texels to spherical harmonics: sums with the weights of sh::cubeWeights, Omega (2 y(centre) - mean y). A work
// group is a point, an invocation a coefficient, ORDER² of them. Texels without a tile are all sky and need nothing: what
// comes out is the bodies' light and the sky's light that they hide,
//   results[2 (point ORDER² + i)]      xyz: sum of w_i * bodies; w: sum of the open shares of texels
//   results[2 (point ORDER² + i) + 1]  xyz: sum of v_i * hidden share * sky; w: sum of v_i * hidden share
// with v the sky's own weights (capture_sky.comp). Sums have a fixed order, in two stages, so that they keep their digits.
#include "capture_shared.h"

layout(local_size_x = ORDER * ORDER) in;
layout(location = 0) uniform uint first_point;
layout(binding = kUnitValues) uniform samplerBuffer values;
layout(binding = kUnitTexels) uniform usamplerBuffer texels;
layout(binding = kUnitSky) uniform samplerBuffer sky;
layout(binding = kUnitWeights) uniform samplerBuffer weights;
layout(binding = kUnitSkyWeights) uniform samplerBuffer sky_weights;
layout(std430, binding = kBindPoints) readonly buffer Points { PointRecord points[]; };
layout(std430, binding = kBindResults) writeonly buffer Results { vec4 results[]; };

void main() {
  uint i = gl_LocalInvocationIndex, record = first_point + gl_WorkGroupID.x;
  PointRecord point = points[record];
  vec4 bodies = vec4(0.0), hidden = vec4(0.0);
  const uint kStage = 64u;
  for (uint first = 0u; first < point.texel_count; first += kStage) {
    vec4 stage_bodies = vec4(0.0), stage_hidden = vec4(0.0);
    uint end = min(first + kStage, point.texel_count);
    for (uint k = first; k < end; ++k) {
      int at = int(point.first_texel + k);
      vec4 value = texelFetch(values, at);
      int texel = int(texelFetch(texels, at).y);
      int at_weight = texel * ORDER * ORDER + int(i);
      stage_bodies += vec4(texelFetch(weights, at_weight).r * value.rgb, 1.0 - value.a);
      stage_hidden += texelFetch(sky_weights, at_weight).r * value.a * vec4(texelFetch(sky, texel).rgb, 1.0);
    }
    bodies += stage_bodies;
    hidden += stage_hidden;
  }
  uint at = 2u * (record * uint(ORDER * ORDER) + i);
  results[at] = bodies;
  results[at + 1u] = hidden;
}
