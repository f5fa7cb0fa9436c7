// Adds what patches send on, at the vertices of diffuse draws (patch_bounces.hpp).
#include "patch_change.glsl"

layout(std430, binding = kBindBounced) readonly buffer Bounced { float bounced_of[]; };

vec3 bouncedAt(uint word) { return vec3(bounced_of[word], bounced_of[word + 1u], bounced_of[word + 2u]); }

void addBounces(uint vertex, inout vec3 radiance) {
  uint word = draws[draw_index].bounced_word + 4u * vertex;
  vec3 change = bouncedAt(word);
  radiance += shareOfChange(radiance, change, bounced_of[word + 3u]) * change;
}

void addBounces(uint vertex, inout vec3 light[kLightCoefficients]) {
  uint word = draws[draw_index].bounced_word + (3u * kLightCoefficients + 1u) * vertex;
  float share = shareOfChange(light[0], bouncedAt(word), bounced_of[word + 3u * kLightCoefficients]);
  for (uint j = 0u; j < kLightCoefficients; ++j) light[j] += share * bouncedAt(word + 3u * j);
}
