// Adds what patches send on: light of bands 0..2 at the corners of a glossy triangle (patch_bounces.hpp).
#include "patch_change.glsl"

layout(std430, binding = kBindGlossyBounced) readonly buffer Bounced { float bounced_of[]; };

void addBounces(uvec3 corners, vec3 weights, inout vec4 light[kCoefficients]) {
  vec3 change[9];
  float by_bands = 0.0;
  for (int k = 0; k < 9; ++k) change[k] = vec3(0.0);
  for (int corner = 0; corner < 3; ++corner) {
    uint word = draws[draw_of].bounced_word + 28u * corners[corner];
    for (uint k = 0u; k < 9u; ++k)
      change[k] += weights[corner] * vec3(bounced_of[word + 3u * k], bounced_of[word + 3u * k + 1u], bounced_of[word + 3u * k + 2u]);
    by_bands += weights[corner] * bounced_of[word + 27u];
  }
  float share = shareOfChange(light[0].rgb, change[0], by_bands);
  for (int k = 0; k < min(kUsedCoefficients, 9); ++k) light[k].rgb += share * change[k];
}
