// Receives light on smooth dielectrics that are shaded at their vertices: interpolates their E/pi, under a specular
// layer.
#include "surface_normal.glsl"
#include "surface_light.glsl"

layout(location = 3) in vec3 radiance;
layout(location = 3, component = 3) in float straight;  // as of a SurfacePoint
layout(location = 4) in vec3 normal_group;  // on the visible side
layout(location = 5) in vec3 position_mesh;
layout(location = 6) in vec4 looks_at_reflection;

#include "texel_light.glsl"
#include "layer.glsl"

vec3 shadingNormal() { return unit(normal_group); }

vec3 reflectedLight(vec3 base_color) {
  vec3 normal = shadingNormal();
  lookAtLayer(base_color, TangentFrame(normal, vec3(0.0), 1.0), normal, position_mesh);
  SurfaceLight light = kNoLight;
  receiveLight(SurfacePoint(draws[draw_of].glossy.draw, position_mesh, normal_group, normal, straight), light);
  return throughLayer(base_color, Mirror(normal, position_mesh, vec3(0.0)), transferredLight(radiance), light);
}
