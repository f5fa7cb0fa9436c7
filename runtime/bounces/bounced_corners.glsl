// Adds what patches send on: light of bands 0..2 at the corners of a glossy triangle (patch_bounces.hpp).
layout(std430, binding = kBindGlossyBounced) readonly buffer Bounced { float bounced_of[]; };

void addBounces(uvec3 corners, vec3 weights, inout vec4 light[kCoefficients]) {
  uint word = draws[draw_of].bounced_word;
  for (int corner = 0; corner < 3; ++corner)
    for (int k = 0; k < min(kUsedCoefficients, 9); ++k) {
      uint at = word + 3u * (9u * corners[corner] + uint(k));
      light[k].rgb += weights[corner] * vec3(bounced_of[at], bounced_of[at + 1u], bounced_of[at + 2u]);
    }
}
