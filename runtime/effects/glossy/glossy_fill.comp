// Fills the samples of cells without transfer with the light itself, with one invocation per output of a sample.
#include "glossy_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindLights) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = kBindFills) readonly buffer Fills { FillRecord fills[]; };
layout(std430, binding = kBindSamples) writeonly buffer Samples { vec4 samples[]; };

#include "glossy_eval.glsl"

vec3 lightAt(uint index) { return lights[index].rgb; }

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  FillRecord fill = fills[work[index].record];
  uint at = work[index].first + gl_LocalInvocationID.x;
  if (at < fill.output_count) samples[fill.first_output + at] = openLight(fill, at % fill.outputs);
}
