// Copies the shaded samples of a volume into its texture, with one invocation per sample. Band l is multiplied with
// g^l, the convolution with the phase function (see volume_march.glsl), so that rays only evaluate it.
#include "volume_shared.h"

layout(local_size_x = kScatterGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindLights) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = kBindScatter) readonly buffer Scatter { ScatterRecord records[]; };
layout(std430, binding = kBindVoxels) readonly buffer Voxels { uint voxels[]; };
layout(std430, binding = kBindSamples) readonly buffer Samples { vec4 samples[]; };
#ifdef LAMBENT_PRECISE
layout(binding = kImageLight, rgba32f) writeonly uniform image3D light_image;
const float kLargest = 3e38;
#else
layout(binding = kImageLight, rgba16f) writeonly uniform image3D light_image;
const float kLargest = 65504.0;  // an infinite texel would make its neighbours NaN
#endif

const float kY00 = 0.282094792;

// Returns the light that arrives at an open place. With one output this is its mean over all directions.
vec3 openLight(ScatterRecord record, uint output_index) {
  if (output_index >= record.open) return vec3(0.0);
  vec3 light = lights[record.light + output_index].rgb;
  return record.outputs == 1u ? kY00 * light : light;
}

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  ScatterRecord record = records[work[index].record];
  uint at = work[index].first + gl_LocalInvocationID.x;
  if (at >= record.sample_count) return;
  uint voxel = voxels[record.first_voxel + at];
  uvec3 place = uvec3(voxel % record.size[0], voxel / record.size[0] % record.size[1],
                      voxel / (record.size[0] * record.size[1]));
  uint band = 0u;
  float factor = 1.0;
  for (uint j = 0u; j < record.outputs; ++j) {
    if (j >= (band + 1u) * (band + 1u)) {
      ++band;
      factor *= record.g;
    }
    vec3 light = record.open > 0u ? openLight(record, j) : samples[record.first_output + record.outputs * at + j].rgb;
    uvec3 texel = place + uvec3(record.size[0] * (j / record.slabs_z), 0u, record.size[2] * (j % record.slabs_z));
    // Alpha 1 marks a voxel with light; lookups leave out voxels without a sample.
    imageStore(light_image, ivec3(texel), vec4(clamp(factor * light, -kLargest, kLargest), 1.0));
  }
}
