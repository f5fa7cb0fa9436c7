// Fills the samples of cells without transfer with the light itself, with one invocation per output of a sample.
#include "transfer_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindLights) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = kBindFills) readonly buffer Fills { FillRecord fills[]; };
layout(std430, binding = kBindSamples) writeonly buffer Samples { vec4 samples[]; };

const float kSqrtFourPi = 3.5449077018110318;

vec3 lightAt(uint index) { return lights[index].rgb; }

// Returns one output of an open sample: all of the light, and visibility 1. For a neighborhood both are 0, no change.
vec4 openLight(FillRecord fill, uint output_index) {
  vec3 light = output_index < fill.coefficients ? lightAt(fill.light + output_index) : vec3(0.0);
  return vec4(light, output_index == 0u && fill.open != 0u ? kSqrtFourPi : 0.0);
}

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  FillRecord fill = fills[work[index].record];
  uint at = work[index].first + gl_LocalInvocationID.x;
  if (at < fill.output_count) samples[fill.first_output + at] = openLight(fill, at % fill.outputs);
}
