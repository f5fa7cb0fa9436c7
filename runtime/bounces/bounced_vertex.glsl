// Adds what patches send on, at the vertices of diffuse draws (patch_bounces.hpp).
layout(std430, binding = kBindBounced) readonly buffer Bounced { float bounced_of[]; };

vec3 bouncedAt(uint place) {
  uint at = draws[draw_index].bounced_word + 3u * place;
  return vec3(bounced_of[at], bounced_of[at + 1u], bounced_of[at + 2u]);
}

void addBounces(uint vertex, inout vec3 radiance) { radiance += bouncedAt(vertex); }

void addBounces(uint vertex, inout vec3 light[kLightCoefficients]) {
  for (uint j = 0u; j < kLightCoefficients; ++j) light[j] += bouncedAt(kLightCoefficients * vertex + j);
}
