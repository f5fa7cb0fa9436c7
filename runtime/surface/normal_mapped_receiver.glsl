// Receives light on surfaces with a normal map: interpolates light of bands 0..2 and convolves it at the pixel's
// normal. With LAMBENT_LAYERED a specular layer lies over it.
#include "mapped_normal.glsl"
#include "surface_light.glsl"
#include "diffuse_light.glsl"

layout(location = 6) in vec4 packed_light[7];
#ifdef LAMBENT_LAYERED
layout(location = 13) in vec4 looks_at_reflection;
layout(location = 14) in vec3 position_mesh;
#endif

// Unpacks the light of bands 0..2, which comes as seven vectors of four numbers: nine of three would take two locations
// more than OpenGL 4.5 has for layered surfaces.
vec3[kLightCoefficients] lightOfBands() {
  vec3 light[kLightCoefficients];
  for (int i = 0; i < 27; ++i) light[i / 3][i % 3] = packed_light[i / 4][i % 4];
  return light;
}

#include "layer.glsl"

vec3 reflectedLight(vec3 base_color) {
  TangentFrame frame = pixelFrame();
  vec3 normal = pixelNormal(frame);
  SurfaceLight light = kNoLight;
#ifdef LAMBENT_LAYERED
  vec3 smooth_normal = draws[draw_of].facing * frame.normal;
  lookAtLayer(base_color, frame, normal, position_mesh);
  receiveLight(SurfacePoint(draws[draw_of].glossy.draw, position_group.xyz, smooth_normal, normal, kStraightUnknown), light);
  return throughLayer(base_color, Mirror(smooth_normal, position_mesh, vec3(0.0)), diffuseLight(lightOfBands(), normal), light);
#else
  receiveLight(SurfacePoint(draw_of, position_group.xyz, draws[draw_of].facing * normal_group.xyz, normal, kStraightUnknown), light);
  vec3 received = withLight(diffuseLight(lightOfBands(), normal), light);
  return kShown == kShownIrradiance ? received : received * base_color;
#endif
}
