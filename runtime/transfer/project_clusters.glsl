// Stage a of all effects multiplies the mean and axes of clusters with the light. A work group handles kUnitsPerGroup
// units, each one output of one cluster under one light. The offsets of the weights go into the mean's product and
// their scales into the axes', so that a sample needs one multiply-add per axis and channel. An entry shader defines
// projected().
#include "transfer_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindLights) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = kBindTransfers) readonly buffer Transfers { TransferRecord transfers[]; };
layout(std430, binding = kBindPlaces) readonly buffer Places { uint places[]; };
layout(std430, binding = kBindProducts) writeonly buffer Products { vec4 products[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { uint page[]; };

shared vec4 means[kWorkGroupSize];

vec3 lightAt(uint index) { return lights[index].rgb; }
float vectorAt(uint word) { return uintBitsToFloat(page[word]); }

// Returns one output of a mean or axis times the light whose coefficients start at `light`.
vec4 projected(TransferRecord transfer, uint vector, uint output_index, uint light);

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  TransferRecord transfer = transfers[work[index].record];
  uint lane = gl_LocalInvocationID.x % kLanesPerUnit;
  uint unit = work[index].first + gl_LocalInvocationID.x / kLanesPerUnit;
  uint output_index = unit % transfer.outputs, cluster = unit / transfer.outputs % transfer.clusters;
  uint light_index = unit / (transfer.outputs * transfer.clusters);
  bool there = light_index < transfer.light_count;
  uint first_product = transfer.first_product + transfer.light_products * light_index;
  vec4 mean = vec4(0.0);
  uint first = 0u;
  if (there) {
    first = page[transfer.clusters_word + 2u * cluster];
    uint light = places[transfer.first_light + light_index];
    uint axes = min(page[transfer.clusters_word + 2u * cluster + 1u], transfer.plane_count);
    for (uint v = lane; v <= axes; v += kLanesPerUnit) {
      uint vector = first + v;
      vec4 value = projected(transfer, vector, output_index, light);
      mean += vectorAt(transfer.weights_word + 2u * vector) * value;
      if (v > 0u)
        products[first_product + transfer.outputs * vector + output_index] =
            vectorAt(transfer.weights_word + 2u * vector + 1u) * value;
    }
  }
  means[gl_LocalInvocationID.x] = mean;
  barrier();
  if (there && lane == 0u) {
    vec4 total = vec4(0.0);
    for (uint i = 0u; i < kLanesPerUnit; ++i) total += means[gl_LocalInvocationID.x + i];
    products[first_product + transfer.outputs * first + output_index] = total;
  }
}
