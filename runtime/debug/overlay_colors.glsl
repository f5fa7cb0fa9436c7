// Converts colours for overlays: to display colours, or with LAMBENT_LINEAR to light.
#include "tone_curve.glsl"
#include "view_colors.glsl"

struct Exposure {
  float scale;
  uint negative_pixels;
};
layout(std430, binding = 7) readonly buffer ExposureBuffer { Exposure exposure; };

// Returns radiance as the picture shows it.
vec3 shownLight(vec3 radiance) {
#ifdef LAMBENT_LINEAR
  return radiance;
#else
  return srgbFromLinear(toneCurve(exposure.scale * clamp(radiance, vec3(0.0), vec3(kLargest))));
#endif
}

// Returns a colour that is given by its sRGB values.
vec3 shownColor(vec3 coded) {
#ifdef LAMBENT_LINEAR
  return displayed(coded);
#else
  return coded;
#endif
}
