// E/pi times albedo (factor x texture x vertex colour), or what a glossy surface makes of its light, and what the
// surface gives off itself. Linear, not clamped;
// alpha is coverage. With LAMBENT_SHADOWED_LIGHTS, lights among the surfaces add theirs per pixel, with LAMBENT_KEY_LIGHTS those at infinity that few bands cannot carry, with LAMBENT_NEIGHBORHOODS
// bodies around change what arrives. With LAMBENT_DARK nothing is reflected: the effect that shades it is off. LAMBENT_VIEW_IRRADIANCE:
// what arrives, E/pi; LAMBENT_VIEW_NORMALS: where the surface faces (views.hpp).
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

#if defined(LAMBENT_NORMAL_MAPPED) || defined(LAMBENT_GLOSSY) || defined(LAMBENT_NEIGHBORHOODS) || defined(LAMBENT_KEY_LIGHTS) || defined(LAMBENT_VIEW_NORMALS)
#include "surface_normal.glsl"
#endif
#if defined(LAMBENT_NORMAL_MAPPED) || defined(LAMBENT_GLOSSY)
layout(binding = kUnitNormal) uniform sampler2D normal_texture;
layout(location = 3) in vec4 position_group;
layout(location = 4) in vec4 normal_group;
layout(location = 5) in vec4 tangent_group;

// Of the vertices, or of the pictures: the front's.
TangentFrame pixelFrame() {
  vec2 at = vec2(position_group.w, normal_group.w);
  vec3 normal = unit(normal_group.xyz);
  TangentFrame from_picture =
      frameFromDerivatives(normal, dFdx(position_group.xyz), dFdy(position_group.xyz), dFdx(at), dFdy(at));
  bool stored = draws[draw_of].tangents_word != kAbsent;
  return stored ? frameFromTangent(normal, tangent_group) : from_picture;
}

// Of the side that is seen, in the group's frame.
vec3 pixelNormal(TangentFrame frame) {
  vec3 normal = frame.normal;
  if (draws[draw_of].normal_texture.set != kAbsent) {
    vec2 at = vec2(position_group.w, normal_group.w);
    normal = perturbedNormal(frame, look(normal_texture, at).xyz, draws[draw_of].normal_scale);
  }
  return draws[draw_of].facing * normal;
}
#ifndef LAMBENT_GLOSSY
#include "diffuse_light.glsl"
layout(location = 6) in vec3 light[kLightCoefficients];
#endif
#else
layout(location = 3) in vec3 radiance;
#if defined(LAMBENT_SHADOWED_LIGHTS) || defined(LAMBENT_KEY_LIGHTS) || defined(LAMBENT_NEIGHBORHOODS) || defined(LAMBENT_VIEW_NORMALS)
layout(location = 4) in vec3 normal_group;  // of the side that is seen
#endif
#ifdef LAMBENT_NEIGHBORHOODS
layout(location = 5) in vec3 position_mesh;
#endif
#endif

#if defined(LAMBENT_SHADOWED_LIGHTS) || defined(LAMBENT_KEY_LIGHTS)
#include "local_shared.h"
#include "shadowed_light.glsl"
#endif

#ifdef LAMBENT_SHADOWED_LIGHTS
#include "local_surface.glsl"
#endif

#ifdef LAMBENT_KEY_LIGHTS
#include "key_surface.glsl"
#endif

#ifdef LAMBENT_NEIGHBORHOODS
#include "neighborhood_surface.glsl"
#endif

#ifdef LAMBENT_GLOSSY
#include "glossy_surface.glsl"
#else
vec3 reflectedLight(vec3 base_color) {
#ifdef LAMBENT_NORMAL_MAPPED
  vec3 normal = pixelNormal(pixelFrame());
  vec3 received = diffuseLight(light, normal);
#else
  vec3 received = radiance;
#endif
#ifdef LAMBENT_NEIGHBORHOODS
#ifdef LAMBENT_NORMAL_MAPPED
  received = withChange(received, changeAround(draw_of, position_group.xyz, normal));
#else
  received = withChange(received, changeAround(draw_of, position_mesh, unit(normal_group)));
#endif
#endif
#ifdef LAMBENT_SHADOWED_LIGHTS
#ifdef LAMBENT_NORMAL_MAPPED
  received += shadowedLight(draw_of, draws[draw_of].facing * normal_group.xyz, normal);
#else
  received += shadowedLight(draw_of, normal_group, normal_group);
#endif
#endif
#ifdef LAMBENT_KEY_LIGHTS
#ifdef LAMBENT_NORMAL_MAPPED
  vec3 straight = keyLight(draw_of, normal);
#else
  vec3 straight = keyLight(draw_of, unit(normal_group));
#endif
#ifdef LAMBENT_NEIGHBORHOODS
  // A volume takes the same share of the key lights that arrive here as it would of all of them.
  received = (received + straight) * max(1.0 + change_of_all / max(received + key_open, vec3(1e-6)), vec3(0.0));
#else
  received += straight;
#endif
#endif
#ifdef LAMBENT_VIEW_IRRADIANCE
  return received;
#endif
  return received * base_color;
}
#endif

#ifdef LAMBENT_VIEW_NORMALS
#include "view_colors.glsl"

vec3 normalColor() {
#if defined(LAMBENT_NORMAL_MAPPED) || defined(LAMBENT_GLOSSY)
  vec3 normal = pixelNormal(pixelFrame());
#else
  vec3 normal = unit(normal_group);
#endif
  // world_from_mesh = world_from_group group_from_mesh; what is flat has no inverse and stays as it is.
  mat3 group_from_mesh = mat3(draws[draw_of].group_from_mesh);
  if (abs(determinant(group_from_mesh)) > 1e-18)
    normal = unit(mat3(draws[draw_of].world_from_mesh) * inverse(group_from_mesh) * normal);
#ifdef LAMBENT_FINEST_TEXELS
  return 0.5 * normal + 0.5;
#else
  return displayed(0.5 * normal + 0.5);
#endif
}
#endif

void main() {
  vec4 albedo = draws[draw_of].base_color * vertex_color;
  if (draws[draw_of].base_color_texture.set != kAbsent) albedo *= look(base_color_texture, looks_at.xy);
  vec3 emission = draws[draw_of].emission.rgb;
  if (draws[draw_of].emissive_texture.set != kAbsent) emission *= look(emissive_texture, looks_at.zw).rgb;
  vec3 reflected = reflectedLight(albedo.rgb);
#ifndef LAMBENT_VIEW_IRRADIANCE
  if (draws[draw_of].unlit != 0u) reflected = albedo.rgb;  // the base colour as it is
#endif

  uint mode = draws[draw_of].alpha_mode;
  if (mode == kAlphaMask && albedo.a < draws[draw_of].alpha_cutoff) discard;
  float alpha = mode == kAlphaBlend ? albedo.a : 1.0;
#ifdef LAMBENT_VIEW_NORMALS
  color = vec4(normalColor(), 1.0);
#elif defined(LAMBENT_VIEW_IRRADIANCE)
  color = vec4(reflected, 1.0);
#else
  color = vec4(reflected + emission, alpha);
#endif
}
