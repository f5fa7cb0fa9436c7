// E/pi times albedo (factor x texture x vertex colour), and what the surface gives off itself. Linear, not clamped;
// alpha is coverage. With LAMBENT_NEAR_LIGHTS, lights among the surfaces add theirs per pixel.
#include "surface_shared.h"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(binding = kUnitBaseColor) uniform sampler2D base_color_texture;
layout(binding = kUnitEmissive) uniform sampler2D emissive_texture;

layout(location = 0) flat in uint draw_of;
layout(location = 1) in vec4 looks_at;
layout(location = 2) in vec4 vertex_color;
layout(location = 0) out vec4 color;

vec4 look(sampler2D image, vec2 at) {
#ifdef LAMBENT_FINEST_TEXELS
  return textureLod(image, at, 0.0);  // what one ray through the pixel's centre would see
#else
  return texture(image, at);
#endif
}

#ifdef LAMBENT_NORMAL_MAPPED
#include "surface_normal.glsl"
#include "diffuse_light.glsl"
layout(binding = kUnitNormal) uniform sampler2D normal_texture;
layout(location = 3) in vec4 position_group;
layout(location = 4) in vec4 normal_group;
layout(location = 5) in vec4 tangent_group;
layout(location = 6) in vec3 light[kLightCoefficients];

// Of the side that is seen, in the group's frame.
vec3 pixelNormal() {
  vec2 at = vec2(position_group.w, normal_group.w);
  vec3 normal = unit(normal_group.xyz);
  TangentFrame from_picture =
      frameFromDerivatives(normal, dFdx(position_group.xyz), dFdy(position_group.xyz), dFdx(at), dFdy(at));
  if (draws[draw_of].normal_texture.set != kAbsent) {
    bool stored = draws[draw_of].tangents_word != kAbsent;
    TangentFrame frame = stored ? frameFromTangent(normal, tangent_group) : from_picture;
    normal = perturbedNormal(frame, look(normal_texture, at).xyz, draws[draw_of].normal_scale);
  }
  return draws[draw_of].facing * normal;
}
#else
layout(location = 3) in vec3 radiance;
#ifdef LAMBENT_NEAR_LIGHTS
layout(location = 4) in vec3 normal_group;  // of the side that is seen
#endif
#endif

#ifdef LAMBENT_NEAR_LIGHTS
#include "near_surface.glsl"
#endif

vec3 receivedLight() {
#ifdef LAMBENT_NORMAL_MAPPED
  vec3 normal = pixelNormal();
  vec3 received = diffuseLight(light, normal);
#else
  vec3 received = radiance;
#endif
#ifdef LAMBENT_NEAR_LIGHTS
#ifdef LAMBENT_NORMAL_MAPPED
  received += nearLight(draw_of, draws[draw_of].facing * normal_group.xyz, normal);
#else
  received += nearLight(draw_of, normal_group, normal_group);
#endif
#endif
  return received;
}

void main() {
  vec4 albedo = draws[draw_of].base_color * vertex_color;
  if (draws[draw_of].base_color_texture.set != kAbsent) albedo *= look(base_color_texture, looks_at.xy);
  vec3 emission = draws[draw_of].emission.rgb;
  if (draws[draw_of].emissive_texture.set != kAbsent) emission *= look(emissive_texture, looks_at.zw).rgb;
  vec3 received = receivedLight();
  if (draws[draw_of].unlit != 0u) received = vec3(1.0);  // the base colour as it is

  uint mode = draws[draw_of].alpha_mode;
  if (mode == kAlphaMask && albedo.a < draws[draw_of].alpha_cutoff) discard;
  float alpha = mode == kAlphaBlend ? albedo.a : 1.0;
  color = vec4(received * albedo.rgb + emission, alpha);
}
