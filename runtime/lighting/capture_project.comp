// From the atlas to spherical harmonics; a work group is a point. Of each texel that a tile covers, the mean radiance of
// the bodies over its subsamples, and how much of it they hide; then sums with the weights of sh::cubeWeights,
// Omega (2 y(centre) - mean y). Texels without a tile are all sky and need nothing: what comes out is the bodies' light
// and the sky's light that they hide,
//   results[2 (point n² + i)]      xyz: sum of w_i * bodies; w of i = 0: subsamples that see the sky
//   results[2 (point n² + i) + 1]  xyz: sum of w_i * hidden share * sky; w: sum of w_i * hidden share
// Sums have a fixed order.
#include "capture_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(location = 0) uniform uint first_point;
layout(location = 1) uniform uint subsamples;
layout(location = 2) uniform uint coefficient_count;
layout(binding = kUnitIds) uniform usampler2D ids;
layout(binding = kUnitDepth) uniform sampler2D depths;
layout(std430, binding = kBindPoints) readonly buffer Points { PointRecord points[]; };
layout(std430, binding = kBindTexels) readonly buffer Texels { uvec2 texels[]; };
layout(std430, binding = kBindWeights) readonly buffer Weights { float weights[]; };
layout(std430, binding = kBindSky) readonly buffer Sky { vec4 sky[]; };
layout(std430, binding = kBindRadiance) readonly buffer Radiance { vec4 triangle_radiance[]; };
layout(std430, binding = kBindLookups) readonly buffer Lookups { uvec2 lookups[]; };
layout(std430, binding = kBindResults) writeonly buffer Results { vec4 results[]; };
layout(std430, binding = kBindHidden) writeonly buffer Hidden { uint hidden_words[]; };

shared vec3 body_light[kWorkGroupSize];
shared vec4 hidden_sky[kWorkGroupSize];
shared uint cube_texels[kWorkGroupSize];
shared uint open_subsamples;

vec3 radianceOf(uint id) {
  if (id == 0u || id == kBlackId) return vec3(0.0);
  vec3 radiance = triangle_radiance[id - 1u].rgb;
  // One bad value must not spoil a whole light; not isnan, which compilers may take for false.
  return mix(vec3(0.0), radiance, lessThan(abs(radiance), vec3(3.0e38)));
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  PointRecord point = points[first_point + gl_WorkGroupID.x];
  float one_over_count = 1.0 / float(subsamples * subsamples);
  vec3 bodies = vec3(0.0);
  vec4 hidden = vec4(0.0);
  uint open_count = 0u;
  if (lane == 0u) open_subsamples = 0u;

  for (uint first = 0u; first < point.texel_count; first += kWorkGroupSize) {
    uint count = min(kWorkGroupSize, point.texel_count - first);
    barrier();
    if (lane < count) {
      uvec2 texel = texels[point.first_texel + first + lane];
      ivec2 origin = ivec2(texel.x & 0xffffu, texel.x >> 16u);
      // Neighbours mostly see the same triangle: its radiance is fetched once per run.
      uint id = 0u, run = 0u, covered = 0u;
      vec3 sum = vec3(0.0);
      for (uint y = 0u; y < subsamples; ++y)
        for (uint x = 0u; x < subsamples; ++x) {
          uint here = texelFetch(ids, origin + ivec2(x, y), 0).r;
          if (here != id) {
            sum += float(run) * one_over_count * radianceOf(id);
            id = here;
            run = 0u;
          }
          ++run;
          covered += min(here, 1u);
        }
      sum += float(run) * one_over_count * radianceOf(id);
      float share = float(covered) * one_over_count;
      body_light[lane] = sum;
      hidden_sky[lane] = vec4(share * sky[texel.y].rgb, share);
      cube_texels[lane] = texel.y;
      open_count += subsamples * subsamples - covered;
    }
    barrier();
    if (lane < coefficient_count) {
      vec3 batch_bodies = vec3(0.0);
      vec4 batch_hidden = vec4(0.0);
      for (uint i = 0u; i < count; ++i) {
        float weight = weights[cube_texels[i] * coefficient_count + lane];
        batch_bodies += weight * body_light[i];
        batch_hidden += weight * hidden_sky[i];
      }
      bodies += batch_bodies;
      hidden += batch_hidden;
    }
  }
  atomicAdd(open_subsamples, open_count);
  barrier();
  if (lane < coefficient_count) {
    uint at = 2u * ((first_point + gl_WorkGroupID.x) * coefficient_count + lane);
    results[at] = vec4(bodies, float(open_subsamples));
    results[at + 1u] = hidden;
  }

  for (uint word = lane; word < point.word_count; word += kWorkGroupSize) {
    uint bits = 0u;
    for (uint i = 0u; i < kLookupsPerWord; ++i) {
      uvec2 lookup = lookups[(point.first_word + word) * kLookupsPerWord + i];
      if (lookup.x == kNoPixel) continue;
      float depth = texelFetch(depths, ivec2(lookup.x & 0xffffu, lookup.x >> 16u), 0).r;
      // Reversed depth: what is nearer than the light is greater.
      if (depth > uintBitsToFloat(lookup.y)) bits |= 1u << i;
    }
    hidden_words[point.first_word + word] = bits;
  }
}
