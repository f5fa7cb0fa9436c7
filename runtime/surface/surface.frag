// Computes what a surface sends towards the eye: the light that it reflects and the light that it emits. The result
// is linear and not clamped; alpha is coverage. The program is put together from a receiver, which handles the light
// that transfer brings (diffuse_receiver.glsl, normal_mapped_receiver.glsl, glossy_receiver.glsl), and from modules that
// add other light. Surfaces writes the files that join them: surface_kind.glsl, receiver.glsl, received_light.glsl.
#include "surface_shared.h"
#include "surface_kind.glsl"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(location = 0) flat in uint draw_of;
layout(location = 1) in vec4 looks_at;      // texture coordinates; xy: base colour, zw: emission
layout(location = 2) in vec4 vertex_color;

vec4 look(sampler2D image, vec2 at) { return kFinestTexels ? textureLod(image, at, 0.0) : texture(image, at); }

layout(binding = kUnitBaseColor) uniform sampler2D base_color_texture;
layout(binding = kUnitEmissive) uniform sampler2D emissive_texture;
layout(location = 0) out vec4 color;

#include "receiver.glsl"
#include "view_colors.glsl"

// Returns the world-space normal as a colour.
vec3 normalColor() {
  vec3 normal = shadingNormal();
  // world_from_mesh = world_from_group group_from_mesh. The matrix of a flattened mesh has no inverse, and its normal
  // stays as it is.
  mat3 group_from_mesh = mat3(draws[draw_of].group_from_mesh);
  if (abs(determinant(group_from_mesh)) > 1e-18)
    normal = unit(mat3(draws[draw_of].world_from_mesh) * inverse(group_from_mesh) * normal);
  vec3 coded = 0.5 * normal + 0.5;
  return kFinestTexels ? coded : displayed(coded);
}

void main() {
  vec4 albedo = draws[draw_of].base_color * vertex_color;
  if (draws[draw_of].base_color_texture.set != kAbsent) albedo *= look(base_color_texture, looks_at.xy);
  vec3 emission = draws[draw_of].emission.rgb;
  if (draws[draw_of].emissive_texture.set != kAbsent) emission *= look(emissive_texture, looks_at.zw).rgb;
  float transmission = draws[draw_of].transmission;
  vec3 shown = reflectedLight((1.0 - transmission) * albedo.rgb);
  if (kShown == kShownRadiance && draws[draw_of].unlit != 0u) shown = albedo.rgb;  // shows the base colour itself

  uint mode = draws[draw_of].alpha_mode;
  if (mode == kAlphaMask && albedo.a < draws[draw_of].alpha_cutoff) discard;
  if (kShown == kShownNormals) shown = normalColor();
  if (kShown != kShownRadiance) {
    color = vec4(shown, 1.0);
  } else if (transmission > 0.0) {
    // A pane adds all that it reflects to what it passes. Blending multiplies its colour by its coverage.
    float passed = (1.0 - draws[draw_of].pane_reflectance) * transmission * dot(albedo.rgb, vec3(1.0 / 3.0));
    float coverage = max(1.0 - passed, 1.0 / 1024.0);
    color = vec4((shown + emission) / coverage, coverage);
  } else {
    color = vec4(shown + emission, mode == kAlphaBlend ? albedo.a : 1.0);
  }
}
