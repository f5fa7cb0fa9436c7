// This is the last pass. It counts negative pixels and makes the displayed picture: clamped, exposed, through a tone
// curve and sRGB-coded (sample by sample, so that edges against bright sky stay smooth). Linear pictures keep their
// values and signs.
#include "hdr_input.glsl"
#include "tone_curve.glsl"

layout(location = 0) uniform uint as_is;  // 1: the input holds colours, not light
layout(location = 0) out vec4 color;

// Ringing can make single channels negative. Clipping only those would turn a dark grey into a saturated
// blue, so the colour moves towards its own luminance until the lowest channel is 0; without luminance it
// becomes black.
vec3 withoutNegatives(vec3 linear) {
  float low = min(linear.r, min(linear.g, linear.b));
  if (low >= 0.0) return linear;
  float luminance = dot(linear, vec3(0.2126, 0.7152, 0.0722));
  if (luminance <= 0.0) return vec3(0.0);
  return luminance + (linear - luminance) * (luminance / (luminance - low));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 sum = vec4(0.0);
  bool negative = false;
  for (int i = 0; i < kSamples; ++i) {
    vec4 linear = hdrAt(pixel, i);
    negative = negative || (linear.a > 0.0 && any(lessThan(linear.rgb, vec3(0.0))));
#ifdef LAMBENT_LINEAR
    sum += linear;  // signed: pictures are compared with signed references, and clamping would look like an
                    // error
#else
    vec3 shown = max(withoutNegatives(linear.rgb), vec3(0.0));  // max removes rounding errors
    vec3 mapped = as_is != 0u ? shown : toneCurve(exposure.scale * min(shown, vec3(kLargest)));
    sum += vec4(srgbFromLinear(mapped), 1.0);
#endif
  }
  if (negative && as_is == 0u) atomicAdd(exposure.negative_pixels, 1u);
  color = sum / float(kSamples);
}
