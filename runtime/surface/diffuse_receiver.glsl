// Receives light on surfaces that are shaded at their vertices: interpolates their E/pi.
#include "surface_normal.glsl"
#include "surface_light.glsl"

layout(location = 3) in vec3 radiance;
layout(location = 3, component = 3) in float straight;  // as of a SurfacePoint
layout(location = 4) in vec3 normal_group;  // on the visible side
layout(location = 5) in vec3 position_mesh;

#include "texel_light.glsl"

const bool kHighlights = false;
vec3 lightReflectance(vec3 to_light, float spread) { return vec3(0.0); }

#include "received_light.glsl"

vec3 shadingNormal() { return unit(normal_group); }

vec3 reflectedLight(vec3 base_color) {
  SurfaceLight light = kNoLight;
  receiveLight(SurfacePoint(draw_of, position_mesh, normal_group, unit(normal_group), straight), light);
  vec3 received = withLight(transferredLight(radiance), light);
  return kShown == kShownIrradiance ? received : received * base_color;
}
