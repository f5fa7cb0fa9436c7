// Runs local_shadow.glsl on cases from a buffer, in a synthetic world.
#include "local_shared.h"
#include "local_shadow.glsl"

layout(local_size_x = 64) in;

struct Case {
  ShadowedLightRecord light;
  vec3 position;
  float turns;
  vec3 normal;
  float pad0;
  vec3 horizon;
  float pad2;
  vec3 shading_normal;
  float pad1;
};
layout(std430, binding = 0) readonly buffer Cases { Case cases[]; };
layout(std430, binding = 1) writeonly buffer Results { vec4 results[]; };
layout(location = 0) uniform uint count;

const int kSize = 64;

// The world has a floor at y = -1, and blocks of eight texels at half a metre on a chequered half of the sky.
float localDistance(int light, int face, ivec2 texel) {
  if (((texel.x / 8 + texel.y / 8 + face) & 1) == 0 && face != 3) return 0.5 + 0.01 * float(face);
  vec3 direction = texelDirection(face, vec2(texel) + 0.5, kSize);
  return direction.y < 0.0 ? -1.0 / direction.y : kNothing;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  Case c = cases[i];
  vec3 to_light = c.light.position - c.position;
  vec3 all = localRadiance(0, c.light, c.position, c.normal, c.horizon, c.shading_normal, kSize, 16, c.turns);
  results[i] = vec4(all.xy, localShare(c.light, c.shading_normal, to_light),
                    pixelTurns(vec2(float(i) + 0.5, 37.5)));
}
