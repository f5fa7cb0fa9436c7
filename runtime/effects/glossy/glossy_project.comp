// Stage a of visibility. Other transfers of glossy cells are dense, and diffuse_project.comp does them.
#define LAMBENT_STAGE_PROJECT
#include "glossy_eval.glsl"
#include "project_clusters.glsl"

layout(std430, binding = kBindGaunt) readonly buffer Gaunt { uint gaunt[]; };

uint gauntWordAt(uint word) { return gaunt[word]; }

vec4 projected(TransferRecord transfer, uint vector, uint output_index, uint light) {
  return projectVisibility(transfer, vector, output_index, light);
}
