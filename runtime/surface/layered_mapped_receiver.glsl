// Receives light on smooth dielectrics with a normal map: convolves light of bands 0..2 at the pixel's normal, under a
// specular layer.
#include "mapped_normal.glsl"
#include "surface_light.glsl"
#include "diffuse_light.glsl"
#include "packed_light.glsl"

layout(location = 13) in vec4 looks_at_reflection;
layout(location = 14) in vec3 position_mesh;

#include "layer.glsl"

vec3 reflectedLight(vec3 base_color) {
  TangentFrame frame = pixelFrame();
  vec3 normal = pixelNormal(frame), smooth_normal = draws[draw_of].facing * frame.normal;
  lookAtLayer(base_color, frame, normal, position_mesh);
  SurfaceLight light = kNoLight;
  receiveLight(SurfacePoint(draws[draw_of].glossy.draw, position_group.xyz, smooth_normal, normal, kStraightUnknown), light);
  return throughLayer(base_color, Mirror(smooth_normal, position_mesh, vec3(0.0)), diffuseLight(lightOfBands(), normal), light);
}
