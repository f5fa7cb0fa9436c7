// Runs key_light.glsl on cases from a buffer, with a shadow map made by key_shader_test.cpp.
#include "local_shared.h"
#include "key_shared.h"
#include "key_light.glsl"

layout(local_size_x = 64) in;

struct Case {
  KeyRecord key;
  vec4 position;
  vec4 normal;
  vec4 shading_normal;
};
layout(std430, binding = 0) readonly buffer Cases { Case cases[]; };
layout(std430, binding = 1) writeonly buffer Results { vec4 results[]; };
layout(location = 0) uniform uint count;
layout(binding = 0) uniform sampler2D depths;
layout(binding = 1) uniform sampler2D blockers;

float keyDepth(ivec2 texel) { return texelFetch(depths, texel, 0).r; }
vec2 keyBlockers(ivec2 texel, int level) { return texelFetch(blockers, texel, level).rg; }

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  Case c = cases[i];
  KeyReceiver receiver = keyReceiver(c.key, c.position.xyz, c.normal.xyz);
  results[2u * i] = vec4(keyVisible(c.key, c.position.xyz, c.normal.xyz, c.shading_normal.xyz),
                         keyShare(c.key, c.shading_normal.xyz), 0.0);
  results[2u * i + 1u] = vec4(blockerBounds(c.key, receiver.place, vec2(c.position.w)), 0.0, 0.0);
}
