// Computes the light of the whole sky as its texels represent it. Each invocation computes one of ORDER²
// coefficients; one work group is dispatched.
#include "capture_shared.h"

layout(local_size_x = ORDER * ORDER) in;
layout(location = 0) uniform uint texel_count;
layout(binding = kUnitSky) uniform samplerBuffer sky;
layout(binding = kUnitWeights) uniform samplerBuffer weights;
layout(std430, binding = kBindSkyLight) writeonly buffer SkyLight { vec4 sky_light[]; };

const uint kQuads = (ORDER * ORDER + 3) / 4;

void main() {
  uint i = gl_LocalInvocationIndex;
  vec3 sum = vec3(0.0);
  const uint kStage = 64u;
  for (uint first = 0u; first < texel_count; first += kStage) {
    vec3 stage = vec3(0.0);
    for (uint k = first; k < min(first + kStage, texel_count); ++k)
      stage += texelFetch(weights, int(k * kQuads + i / 4u))[i % 4u] * texelFetch(sky, int(k)).rgb;
    sum += stage;
  }
  sky_light[i] = vec4(sum, 0.0);
}
