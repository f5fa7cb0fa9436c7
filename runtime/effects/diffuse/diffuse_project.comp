// Stage a, one work group per dirty cell: the cell's mean and basis vectors times the group's light. Offsets of the
// weights go into the mean here, scales into the vectors, so that a sample has one multiply-add per plane and channel.
#include "diffuse_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindLights) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = kBindCells) readonly buffer Cells { CellRecord cells[]; };
layout(std430, binding = kBindVectors) readonly buffer Vectors { VectorRecord vectors[]; };
layout(std430, binding = kBindProducts) writeonly buffer Products { Product products[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { float transfer[]; };

shared vec3 means[kWorkGroupSize];

#define LAMBENT_STAGE_PROJECT
#include "diffuse_eval.glsl"

vec3 lightAt(uint index) { return lights[index].rgb; }
float basisAt(uint word) { return transfer[word]; }

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  CellRecord cell = cells[work[index].record];
  vec3 mean = vec3(0.0);
  for (uint j = gl_LocalInvocationID.x; j < cell.vector_count; j += kWorkGroupSize) {
    VectorRecord vector = vectors[cell.first_vector + j];
#ifdef LAMBENT_ORDER
    vec3 value = projectOnLight(vector, cell.light, LAMBENT_ORDER * LAMBENT_ORDER);
#else
    vec3 value = projectOnLight(vector, cell.light, vector.order * vector.order);
#endif
    mean += vector.offset * value;
    if (vector.slot > 0u) {
      vec3 scaled = vector.scale * value;
      products[cell.first_product + vector.slot] = Product(scaled.r, scaled.g, scaled.b, vector.codes);
    }
  }
  means[gl_LocalInvocationID.x] = mean;
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    vec3 total = vec3(0.0);
    for (uint lane = 0u; lane < kWorkGroupSize; ++lane) total += means[lane];
    products[cell.first_product] = Product(total.r, total.g, total.b, 0u);
  }
}
