// The last pass: counts negative pixels and makes the picture that is looked at: clamped, exposed, through a tone
// curve, sRGB-coded (sample by sample, so that edges against bright sky stay smooth); or linear as it is, signs and all.
#include "hdr_input.glsl"

layout(location = 0) out vec4 color;

const float kLargest = 65504.0;  // brighter suns are infinite in half floats, and the curve would make NaN of that

// Khronos PBR Neutral: colours up to 0.76 pass almost unchanged (4 % are taken off as the specular part that it is
// meant for and Lambert lacks: here that only deepens blacks), brighter ones are compressed and drift to white.
// https://github.com/KhronosGroup/ToneMapping/blob/main/PBR_Neutral/README.md
vec3 toneCurve(vec3 linear) {
  const float kStart = 0.8 - 0.04, kDesaturation = 0.15;
  float low = min(linear.r, min(linear.g, linear.b));
  vec3 mapped = linear - (low < 0.08 ? low - 6.25 * low * low : 0.04);
  float peak = max(mapped.r, max(mapped.g, mapped.b));
  if (peak < kStart) return mapped;
  const float kRange = 1.0 - kStart;
  float new_peak = 1.0 - kRange * kRange / (peak + kRange - kStart);
  mapped *= new_peak / peak;
  float to_white = 1.0 - 1.0 / (kDesaturation * (peak - new_peak) + 1.0);
  return mix(mapped, vec3(new_peak), to_white);
}

// Ringing can leave single channels below zero. Cutting those off alone would turn a dark grey into a saturated blue:
// the colour moves towards its own luminance instead, until the lowest channel is 0; without luminance it is black.
vec3 withoutNegatives(vec3 linear) {
  float low = min(linear.r, min(linear.g, linear.b));
  if (low >= 0.0) return linear;
  float luminance = dot(linear, vec3(0.2126, 0.7152, 0.0722));
  if (luminance <= 0.0) return vec3(0.0);
  return luminance + (linear - luminance) * (luminance / (luminance - low));
}

// IEC 61966-2-1.
vec3 srgbFromLinear(vec3 linear) {
  vec3 low = 12.92 * linear, high = 1.055 * pow(max(linear, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
  return mix(high, low, lessThanEqual(linear, vec3(0.0031308)));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 sum = vec4(0.0);
  bool negative = false;
  for (int i = 0; i < kSamples; ++i) {
    vec4 linear = hdrAt(pixel, i);
    negative = negative || (linear.a > 0.0 && any(lessThan(linear.rgb, vec3(0.0))));
#ifdef LAMBENT_LINEAR
    sum += linear;  // signed: pictures are compared against references that are, and clamping would look like an error
#else
    vec3 shown = max(withoutNegatives(linear.rgb), vec3(0.0));  // max: rounding
    sum += vec4(srgbFromLinear(toneCurve(exposure.scale * min(shown, vec3(kLargest)))), 1.0);
#endif
  }
  if (negative) atomicAdd(exposure.negative_pixels, 1u);
  color = sum / float(kSamples);
}
