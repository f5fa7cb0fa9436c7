// Neighborhoods in the surface pass: what the bodies around change in the light of a pixel. Each grid is looked up at the
// pixel's place, by the direction that the pixel's normal has in the body's frame, so that no coefficient is turned.
#include "neighborhood_eval.glsl"

layout(std430, binding = kBindReceivers) readonly buffer Receivers { Receiver receivers[]; };
layout(std430, binding = kBindArrivals) readonly buffer Arrivals { Arrival arrivals[]; };
layout(binding = kUnitAtlas) uniform sampler3D atlas;

vec4 atlasAt(vec3 texel) { return textureLod(atlas, texel / vec3(textureSize(atlas, 0)), 0.0); }

vec3 change_of_all = vec3(0.0);  // of the last changeAround: of light with key lights among it

// E/pi; position as the arrivals take it, normal in the receiver's group, of the side that is seen.
vec3 changeAround(uint draw, vec3 position, vec3 normal) {
  vec3 sum = vec3(0.0);
  change_of_all = vec3(0.0);
  for (uint a = receivers[draw].first; a < receivers[draw].first + receivers[draw].count; ++a) {
    vec3 place = vec4(position, 1.0) * arrivals[a].grid_from_position;
    float share = gridShare(place, arrivals[a].grid);
    if (share <= 0.0) continue;
    vec3 change = share * gridIrradiance(place, arrivals[a].grid, vec4(normal, 0.0) * arrivals[a].body_from_group);
    if (arrivals[a].whole != 0u)
      change_of_all += change;
    else
      sum += change;
  }
#ifdef LAMBENT_KEY_LIGHTS
  return sum;
#else
  return sum + change_of_all;
#endif
}
