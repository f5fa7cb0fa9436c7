// Stage a for visibility: multiplies visibility with the light. For vectors and matrices see project_vectors.comp.
#include "transfer_shared.h"

vec3 lightAt(uint index);
float vectorAt(uint word);    // word of the transfer page
uint gauntWordAt(uint word);  // word of the table of products

// Returns output i of a mean or axis V of visibility under the light whose coefficients start at `light`:
//   l'_i = sum_jk Gamma_ijk V_k l_j.
// w is the same sum under constant light of radiance 1, which is V_i itself.
vec4 projectVisibility(TransferRecord transfer, uint vector, uint output_index, uint light) {
  uint at = transfer.vectors_word + vector * transfer.vector_size;
  vec3 sum = vec3(0.0);
  uint first_term = transfer.outputs + 1u, end = gauntWordAt(output_index + 1u);
  for (uint t = gauntWordAt(output_index); t < end; ++t) {
    uint jk = gauntWordAt(first_term + kGauntTermWords * t);
    float value = uintBitsToFloat(gauntWordAt(first_term + kGauntTermWords * t + 1u));
    sum += value * vectorAt(at + (jk >> 16u)) * lightAt(light + (jk & 0xffffu));
  }
  return vec4(sum, vectorAt(at + output_index));
}

#include "project_clusters.glsl"

layout(std430, binding = kBindGaunt) readonly buffer Gaunt { uint gaunt[]; };

uint gauntWordAt(uint word) { return gaunt[word]; }

vec4 projected(TransferRecord transfer, uint vector, uint output_index, uint light) {
  return projectVisibility(transfer, vector, output_index, light);
}
