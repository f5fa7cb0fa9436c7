// What a surface sends towards the eye: the light that it receives and reflects, and what it gives off itself. Linear, not
// clamped; alpha is coverage. The program is put together from a receiver, which says what becomes of the light that transfer
// brings (diffuse_receiver.glsl, normal_mapped_receiver.glsl, ggx_receiver.glsl, measured_receiver.glsl), and from modules that
// add other light to it. Surfaces writes the files that join them: surface_kind.glsl, receiver.glsl, received_light.glsl.
#include "surface_look.glsl"

layout(binding = kUnitBaseColor) uniform sampler2D base_color_texture;
layout(binding = kUnitEmissive) uniform sampler2D emissive_texture;
layout(location = 0) out vec4 color;

#include "receiver.glsl"
#include "view_colors.glsl"

// The normal as a colour, in the world.
vec3 normalColor() {
  vec3 normal = shadingNormal();
  // world_from_mesh = world_from_group group_from_mesh; what is flat has no inverse and stays as it is.
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
  vec3 shown = reflectedLight(albedo.rgb);
  if (kShown == kShownRadiance && draws[draw_of].unlit != 0u) shown = albedo.rgb;  // the base colour as it is

  uint mode = draws[draw_of].alpha_mode;
  if (mode == kAlphaMask && albedo.a < draws[draw_of].alpha_cutoff) discard;
  if (kShown == kShownNormals) shown = normalColor();
  if (kShown == kShownRadiance)
    color = vec4(shown + emission, mode == kAlphaBlend ? albedo.a : 1.0);
  else
    color = vec4(shown, 1.0);
}
