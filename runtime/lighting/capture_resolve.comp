// Resolves subsamples to texels: for each texel in a tile, it writes the mean radiance of the bodies over the
// subsamples and the share of subsamples that bodies hide. Then it writes which lookups of the lights are
// hidden. An invocation handles a texel or a word of lookups.
#include "capture_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(location = 0) uniform uint first_texel;
layout(location = 1) uniform uint texel_count;
layout(location = 2) uniform uint first_word;
layout(location = 3) uniform uint word_count;
layout(location = 4) uniform uint subsamples;
layout(binding = kUnitIds) uniform usampler2D ids;
layout(binding = kUnitDepth) uniform sampler2D depths;
layout(std430, binding = kBindTexels) readonly buffer Texels { TexelRecord texels[]; };
layout(std430, binding = kBindRadiance) readonly buffer Radiance { vec4 triangle_radiance[]; };
layout(std430, binding = kBindValues) writeonly buffer Values { vec4 values[]; };
layout(std430, binding = kBindLookups) readonly buffer Lookups { uvec2 lookups[]; };
layout(std430, binding = kBindHidden) writeonly buffer Hidden { uint hidden_words[]; };

ivec2 pixelOf(uint packed_xy) {
  return ivec2(packed_xy & 0xffffu, packed_xy >> 16u);
}

vec3 radianceOf(uint id) {
  if (id == 0u || id == kBlackId) return vec3(0.0);
  vec3 radiance = triangle_radiance[id - 1u].rgb;
  // One bad value must not spoil a whole light. isnan is not used because compilers may assume that it is
  // false.
  return mix(vec3(0.0), radiance, lessThan(abs(radiance), vec3(3.0e38)));
}

vec4 resolved(ivec2 origin) {
  float one_over_count = 1.0 / float(subsamples * subsamples);
  // Neighbours mostly see the same triangle, so its radiance is fetched once per run.
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
  // A fully covered texel gives exactly 1 in spite of rounding.
  return vec4(sum, covered == subsamples * subsamples ? 1.0 : float(covered) * one_over_count);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < texel_count) {
    values[first_texel + i] = resolved(pixelOf(texels[first_texel + i].pixel));
    return;
  }
  i -= texel_count;
  if (i >= word_count) return;
  uint bits = 0u;
  for (uint k = 0u; k < kLookupsPerWord; ++k) {
    uvec2 lookup = lookups[(first_word + i) * kLookupsPerWord + k];
    if (lookup.x == kNoPixel) continue;
    // Depth is reversed, so a surface nearer than the light has a greater depth.
    if (texelFetch(depths, pixelOf(lookup.x), 0).r > uintBitsToFloat(lookup.y)) bits |= 1u << k;
  }
  hidden_words[first_word + i] = bits;
}
