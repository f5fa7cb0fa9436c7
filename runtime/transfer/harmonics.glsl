// Sums light in harmonics. lightAt(), a coefficient of the light, RGB, is the includer's.

// Returns A_l / pi, with the clamped cosine's weights A_l: pi, 2pi/3, pi/4, 0, -pi/24, 0, pi/64 (Ramamoorthi and
// Hanrahan 2001).
float clampedCosineOverPi(int l) {
  const float kWeights[8] = {1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0, 0.0, 1.0 / 64.0, 0.0};
  return kWeights[l];
}

#include "harmonic_steps.glsl"

// Returns the sum over l, m of y_lm(normal) light_lm, the radiance from there; with the clamped cosine, of A_l/pi
// y_lm(normal) light_lm, which is E/pi of an open surface.
vec3 sumOfHarmonics(vec3 normal, uint light, int order, bool clamped_cosine) {
  vec3 sum = vec3(0.0);
  float c = 1.0, s = 0.0, sectoral = kConstantHarmonic;
  for (int m = 0; m < order; ++m) {
    if (m > 0) stepOrder(normal, m, c, s, sectoral);
    float p = sectoral, before = 0.0;
    for (int l = m; l < order; ++l) {
      if (l > m) stepBand(normal.z, l, m, p, before);
      float weight = clamped_cosine ? clampedCosineOverPi(l) : 1.0;
      if (weight == 0.0) continue;
      uint centre = light + uint(l * (l + 1));
      vec3 ring = m == 0 ? lightAt(centre) : c * lightAt(centre + uint(m)) + s * lightAt(centre - uint(m));
      sum += weight * p * ring;
    }
  }
  return sum;
}
