// Copies the texels with bodies that a capture made into whole cubes. A work group handles a point that sees
// any body.
#include "capture_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(location = 0) uniform uint cube_texels;
layout(std430, binding = 0) readonly buffer Points { PointRecord points[]; };
layout(std430, binding = 1) readonly buffer Texels { TexelRecord texels[]; };
layout(std430, binding = 2) readonly buffer Values { vec4 values[]; };
layout(std430, binding = 3) readonly buffer Slots { uint slots[]; };
layout(std430, binding = 4) writeonly buffer Cubes { vec4 cubes[]; };

void main() {
  PointRecord point = points[gl_WorkGroupID.x];
  uint first = slots[gl_WorkGroupID.x] * cube_texels;
  for (uint k = gl_LocalInvocationIndex; k < point.texel_count; k += kWorkGroupSize)
    cubes[first + texels[point.first_texel + k].texel] = values[point.first_texel + k];
}
