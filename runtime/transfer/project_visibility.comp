// Stage a for visibility: multiplies visibility with the light. For vectors and matrices see project_vectors.comp.
#include "visibility_light.glsl"
#include "project_clusters.glsl"

layout(std430, binding = kBindGaunt) readonly buffer Gaunt { uint gaunt[]; };

uint gauntWordAt(uint word) { return gaunt[word]; }

vec4 projected(TransferRecord transfer, uint vector, uint output_index, uint light) {
  return projectVisibility(transfer, vector, output_index, light);
}
