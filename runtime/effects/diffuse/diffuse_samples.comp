// Stage b, one invocation per sample of the dirty cells: mean plus code times product over the resident planes.
#include "diffuse_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindCells) readonly buffer Cells { CellRecord cells[]; };
layout(std430, binding = kBindProducts) readonly buffer Products { Product products[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { uint transfer[]; };
layout(std430, binding = kBindSamples) writeonly buffer Samples { vec4 samples[]; };

#define LAMBENT_STAGE_SAMPLES
#include "diffuse_eval.glsl"

uint codeWordAt(uint word) { return transfer[word]; }

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  CellRecord cell = cells[work[index].record];
  uint sample_index = work[index].first + gl_LocalInvocationID.x;
  if (sample_index >= cell.sample_count) return;
  Product mean = products[cell.first_product];
  vec3 radiance = vec3(mean.r, mean.g, mean.b);
  for (uint j = 1u; j <= cell.plane_count; ++j) {
    Product plane = products[cell.first_product + j];
    radiance += float(codeOf(plane.codes, sample_index)) * vec3(plane.r, plane.g, plane.b);
  }
  samples[cell.first_output + sample_index] = vec4(radiance, 1.0);
}
