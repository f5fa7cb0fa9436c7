// Handles key lights in the surface pass: computes the E/pi that arrives directly from them, with shadows.
#include "key_shared.h"

layout(std140, binding = kBindKeyLights) uniform KeyBlock {
  KeyView key_view;
  KeyRecord key_lights[kMostKeyLights];
};
layout(binding = kUnitKeyShadows) uniform sampler2D key_depths;
layout(binding = kUnitKeyBlockers) uniform sampler2D key_blockers;

#include "key_light.glsl"

float keyDepth(ivec2 texel) { return texelFetch(key_depths, texel, 0).r; }
vec2 keyBlockers(ivec2 texel, int level) { return texelFetch(key_blockers, texel, level).rg; }

// Returns the position in view space. It is computed in homogeneous coordinates whose w is not needed:
// gl_FragCoord.w has the depth at full precision, even where the depth buffer has little.
vec3 keyPixelPosition() {
  vec3 ndc = vec3(2.0 * gl_FragCoord.xy / key_view.picture.xy, 2.0 * gl_FragCoord.z) - 1.0;
  return (key_view.view_from_clip * (vec4(ndc, 1.0) / gl_FragCoord.w)).xyz;
}

vec3 viewFromGroup(uint draw, vec3 v) {
  vec4 turn = draws[draw].world_from_group;
  vec3 world = v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
  return localUnit(mat3(key_view.view_from_world) * world);
}

vec3 groupFromView(uint draw, vec3 v) {
  vec3 world = v * mat3(key_view.view_from_world);
  vec4 turn = vec4(-draws[draw].world_from_group.xyz, draws[draw].world_from_group.w);
  return localUnit(world + 2.0 * cross(turn.xyz, cross(turn.xyz, world) + turn.w * world));
}

// Shares of the light by maps that must arrive by transfer for none and for all of what maps cannot tell.
const float kLeastTold = 0.1, kMostTold = 0.5;

float luminance(vec3 light) { return dot(light, vec3(0.2126, 0.7152, 0.0722)); }  // Rec. 709

// Returns the share of light of which the maps cannot tell that arrives. What few bands of transfer know of all light is
// too coarse to be believed to the number, but it tells a closed room from an open arcade. Where transfer is not known,
// all of it arrives.
float straightShare(float straight, vec3 known, vec3 unsure) {
  float rest = luminance(unsure);
  return straight < 0.0 || rest <= 0.0 ? 1.0 : smoothstep(kLeastTold, kMostTold, straight / (luminance(known) + rest));
}

// Adds the key lights at a point: E/pi with shadows and, on glossy surfaces, highlights. lightReflectance is pi times
// the specular f towards the eye, for light that comes from a direction (group frame) and spreads over so many
// radians.
void addKeyLights(SurfacePoint at, inout SurfaceLight light) {
  light.keys_apart = true;
  vec3 position = keyPixelPosition();
  // The cross product points to the eye, because the picture's axes and the direction to it are right-handed.
  vec3 normal = localUnit(cross(dFdx(position), dFdy(position)));
  vec3 shaded = viewFromGroup(draw_of, at.normal);
  vec3 unsure = vec3(0.0), unsure_highlights = vec3(0.0);
  for (uint k = 0u; k < key_view.count; ++k) {
    float share = keyShare(key_lights[k], shaded);
    if (share <= 0.0) continue;
    vec3 open = share * key_lights[k].radiance.rgb;
    light.open_key += open;
    vec2 visible = keyVisible(key_lights[k], position, normal, shaded);
    light.key += visible.x * open;
    unsure += visible.y * open;
    if (!kHighlights) continue;
    vec3 highlight = open * lightReflectance(groupFromView(draw_of, key_lights[k].towards.xyz), asin(key_lights[k].radiance.w));
    light.key_highlights += visible.x * highlight;
    unsure_highlights += visible.y * highlight;
    light.open_key_highlights += highlight;
  }
  float told = straightShare(at.straight, light.key, unsure);
  light.key += told * unsure;
  light.key_highlights += told * unsure_highlights;
}
