// Handles local lights in the surface pass: computes E/pi of all lights of the draw, with their shadows.
#include "local_shared.h"
#include "local_shadow.glsl"

layout(std140, binding = kBindShadowedLights) uniform LocalBlock {
  ShadowView local_view;
  ShadowedLightRecord shadowed_lights[kShadowedLights];
};
layout(std430, binding = kBindLocalDraws) readonly buffer LocalDraws { LocalDraw local_draws[]; };
layout(binding = kUnitLocalShadows) uniform sampler2D local_shadows;

// Displayed pictures hold half floats, and one infinite pixel beside a small light would upset the exposure.
const float kLargestShown = 6e4;

float localDistance(int light, int face, ivec2 texel) {
  int size = int(local_view.size);
  float depth = texelFetch(local_shadows, ivec2(face, light) * size + texel, 0).r;
  return depth < 1.0 ? depth * shadowed_lights[light].reach : kNothing;
}

// Returns the position in view space. It is computed in homogeneous coordinates whose w is not needed:
// gl_FragCoord.w has the depth at full precision, even where the depth buffer has little.
vec3 pixelPosition() {
  vec3 ndc = vec3(2.0 * gl_FragCoord.xy / vec2(local_view.width, local_view.height), 2.0 * gl_FragCoord.z) - 1.0;
  return (local_view.view_from_clip * (vec4(ndc, 1.0) / gl_FragCoord.w)).xyz;
}

vec3 turned(vec4 turn, vec3 v) { return localUnit(v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v)); }

// Adds the local lights at a point: E/pi and, on glossy surfaces, highlights. lightReflectance is pi times the
// specular f towards the eye, for light that comes from a direction (group frame) and spreads over so many radians.
void addLocalLights(SurfacePoint at, inout SurfaceLight light) {
  vec3 position_vs = pixelPosition();
  vec3 position = (local_view.world_from_view * vec4(position_vs, 1.0)).xyz;
  // The cross product points to the eye, because the picture's axes and the direction to it are right-handed.
  vec3 normal = localUnit(mat3(local_view.world_from_view) * cross(dFdx(position_vs), dFdy(position_vs)));
  vec4 turn = local_draws[at.draw].world_from_group;
  vec3 horizon = turned(turn, at.smooth_normal);
  vec3 shading_normal = turned(turn, at.normal);
  float turns = pixelTurns(gl_FragCoord.xy);
  vec3 sum = vec3(0.0);
  // The loop runs over the bits that are set. On some devices an if costs as much as what it skips, but a loop does
  // not.
  for (uint rest = local_draws[at.draw].lights; rest != 0u; rest &= rest - 1u) {
    int k = findLSB(rest);
    vec3 received = localRadiance(k, shadowed_lights[k], position, normal, horizon, shading_normal, int(local_view.size),
                                 int(local_view.samples), turns);
    sum += received;
    if (!kHighlights) continue;
    vec3 to_light = shadowed_lights[k].position - position;
    bool wide = shadowed_lights[k].kind == kLocalSphere || shadowed_lights[k].kind == kLocalDisc;
    float spread = wide ? atan(shadowed_lights[k].radius, length(to_light)) : 0.0;
    vec3 to_light_group = turned(vec4(-turn.xyz, turn.w), localUnit(to_light));
    light.local_highlights += min(received * lightReflectance(to_light_group, spread), vec3(kLargestShown));
  }
  light.local += kFinestTexels ? sum : min(sum, vec3(kLargestShown));
}
