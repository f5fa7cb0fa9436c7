// Receives light on surfaces with a normal map: interpolates light of bands 0..2 and convolves it at the pixel's
// normal.
#include "mapped_normal.glsl"
#include "surface_light.glsl"
#include "diffuse_light.glsl"

#include "packed_light.glsl"

const bool kHighlights = false;
vec3 lightReflectance(vec3 to_light, float spread) { return vec3(0.0); }

#include "received_light.glsl"

vec3 reflectedLight(vec3 base_color) {
  vec3 normal = shadingNormal();
  SurfaceLight light = kNoLight;
  receiveLight(SurfacePoint(draw_of, position_group.xyz, draws[draw_of].facing * normal_group.xyz, normal, kStraightUnknown), light);
  vec3 received = withLight(diffuseLight(lightOfBands(), normal), light);
  return kShown == kShownIrradiance ? received : received * base_color;
}
