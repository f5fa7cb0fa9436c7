// Receives light on surfaces that are shaded at their vertices: interpolates their E/pi. With LAMBENT_LAYERED a
// specular layer lies over it.
#include "surface_normal.glsl"
#include "surface_light.glsl"

layout(location = 3) in vec3 radiance;
layout(location = 3, component = 3) in float straight;  // as of a SurfacePoint
layout(location = 4) in vec3 normal_group;  // on the visible side
layout(location = 5) in vec3 position_mesh;
#ifdef LAMBENT_LAYERED
layout(location = 6) in vec4 looks_at_reflection;
#endif
layout(location = 7) in vec3 stored_radiance;  // at vertices, without what modules added
layout(location = 8) in vec2 irradiance_at;
layout(binding = kUnitIrradiance) uniform sampler2D irradiance_texture;

// Takes E/pi from the texels of a draw that has some, and from its vertices where these are not shaded yet. What
// modules add at vertices stays.
vec3 transferredLight(vec3 at_vertices) {
  if (!kHasTexels) return at_vertices;
  vec4 texel = look(irradiance_texture, irradiance_at);
  return at_vertices - texel.a * stored_radiance + texel.rgb;
}

vec3 shadingNormal() { return unit(normal_group); }

#include "layer.glsl"

vec3 reflectedLight(vec3 base_color) {
  vec3 normal = shadingNormal();
  SurfaceLight light = kNoLight;
#ifdef LAMBENT_LAYERED
  lookAtLayer(base_color, TangentFrame(normal, vec3(0.0), 1.0), normal, position_mesh);
  receiveLight(SurfacePoint(draws[draw_of].glossy.draw, position_mesh, normal_group, normal, straight), light);
  return throughLayer(base_color, Mirror(normal, position_mesh, vec3(0.0)), transferredLight(radiance), light);
#else
  receiveLight(SurfacePoint(draw_of, position_mesh, normal_group, normal, straight), light);
  vec3 received = withLight(transferredLight(radiance), light);
  return kShown == kShownIrradiance ? received : received * base_color;
#endif
}
