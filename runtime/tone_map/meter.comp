// Computes the automatic exposure: the mean luminance over what the scene covers (over the whole picture if
// it covers nothing) becomes a middle grey. The mean is that of square roots: a geometric mean follows black
// corners, an arithmetic one follows highlights. One work group samples 64 x 64 places of the picture.
#include "hdr_input.glsl"

layout(local_size_x = 16, local_size_y = 16) in;
layout(location = 0) uniform float manual_scale;  // used as the factor if above zero

const float kMiddleGrey = 0.26;  // share of the curve's white; chosen by eye on scans and rooms under the
                                 // shared environment maps
const int kGrid = 64;
shared vec4 sums[256];  // covered: sum, count; all: sum, count

void main() {
  ivec2 size = hdrSize();
  vec4 sum = vec4(0.0);
  for (int y = int(gl_LocalInvocationID.y); y < kGrid; y += 16)
    for (int x = int(gl_LocalInvocationID.x); x < kGrid; x += 16) {
      ivec2 pixel = ivec2((vec2(x, y) + 0.5) / float(kGrid) * vec2(size));
      vec4 color = hdrAt(pixel, 0);
      float luminance = dot(color.rgb, vec3(0.2126, 0.7152, 0.0722));
      if (!(luminance >= 0.0)) continue;
      sum.zw += vec2(sqrt(luminance), 1.0);
      if (color.a > 0.5) sum.xy += vec2(sqrt(luminance), 1.0);
    }
  uint lane = gl_LocalInvocationIndex;
  sums[lane] = sum;
  barrier();
  for (uint half_count = 128u; half_count > 0u; half_count /= 2u) {
    if (lane < half_count) sums[lane] += sums[lane + half_count];
    barrier();
  }
  if (lane != 0u) return;
  vec2 chosen = sums[0].y > 0.0 ? sums[0].xy : sums[0].zw;
  float mean = chosen.y > 0.0 ? pow(chosen.x / chosen.y, 2.0) : 0.0;
  float automatic = mean > 1e-8 ? kMiddleGrey / mean : 1.0;
  exposure.scale = manual_scale > 0.0 ? manual_scale : automatic;
  exposure.negative_pixels = 0u;
}
