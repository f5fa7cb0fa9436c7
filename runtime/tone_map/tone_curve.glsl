// Turns exposed linear colours into display colours.

const float kLargest = 65504.0;  // a brighter sun is infinite in half floats, and the curve would turn that
                                 // into NaN

// The Khronos PBR Neutral curve passes colours up to 0.76 almost unchanged (it subtracts 4 % for a specular
// part, which Lambert surfaces lack; here that only deepens blacks), and compresses brighter ones towards
// white. https://github.com/KhronosGroup/ToneMapping/blob/main/PBR_Neutral/README.md
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

// Applies the sRGB transfer function (IEC 61966-2-1).
vec3 srgbFromLinear(vec3 linear) {
  vec3 low = 12.92 * linear, high = 1.055 * pow(max(linear, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
  return mix(high, low, lessThanEqual(linear, vec3(0.0031308)));
}
