// Key lights in the surface pass: E/pi that arrives from them straight, with shadows.
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

// View space. In homogeneous coordinates of which w is left aside: gl_FragCoord.w has the depth at full precision, also
// where the depth buffer has little.
vec3 keyPixelPosition() {
  vec3 ndc = vec3(2.0 * gl_FragCoord.xy / key_view.picture.xy, 2.0 * gl_FragCoord.z) - 1.0;
  return (key_view.view_from_clip * (vec4(ndc, 1.0) / gl_FragCoord.w)).xyz;
}

vec3 viewFromGroup(uint draw, vec3 v) {
  vec4 turn = draws[draw].world_from_group;
  vec3 world = v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
  return localUnit(mat3(key_view.view_from_world) * world);
}

#ifdef LAMBENT_GLOSSY
vec3 groupFromView(uint draw, vec3 v) {
  vec3 world = v * mat3(key_view.view_from_world);
  vec4 turn = vec4(-draws[draw].world_from_group.xyz, draws[draw].world_from_group.w);
  return localUnit(world + 2.0 * cross(turn.xyz, cross(turn.xyz, world) + turn.w * world));
}

// pi times the specular f towards the eye of light from this direction, group frame, that spreads over so many radians.
vec3 lightReflectance(vec3 to_light, float spread);
vec3 key_highlights = vec3(0.0);       // of the last keyLight
vec3 key_open_highlights = vec3(0.0);  // the same as if nothing were in the way
#endif

vec3 key_open = vec3(0.0);  // of the last keyLight: as if nothing were in the way

// Group frame, of the side that is seen: the normal that the surface is shaded by.
vec3 keyLight(uint draw, vec3 shading_normal) {
  vec3 position = keyPixelPosition();
  // Points to the eye: the picture's axes are right-handed with the direction to it.
  vec3 normal = localUnit(cross(dFdx(position), dFdy(position)));
  vec3 shaded = viewFromGroup(draw, shading_normal);
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < key_view.count; ++k) {
    float share = keyShare(key_lights[k], shaded);
    if (share <= 0.0) continue;
    vec3 open = share * key_lights[k].radiance.rgb;
    key_open += open;
    float visible = keyVisible(key_lights[k], position, normal, shaded);
    sum += visible * open;
#ifdef LAMBENT_GLOSSY
    vec3 highlight = open * lightReflectance(groupFromView(draw, key_lights[k].towards.xyz), asin(key_lights[k].radiance.w));
    key_highlights += visible * highlight;
    key_open_highlights += highlight;
#endif
  }
  return sum;
}
