// Interpolated E/pi times albedo (factor x texture x vertex colour). Linear, not clamped; alpha is coverage.
#include "surface_shared.h"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(binding = 0) uniform sampler2D base_color_texture;

layout(location = 0) in vec3 radiance;
layout(location = 1) in vec2 texcoord;
layout(location = 2) in vec4 vertex_color;
layout(location = 3) flat in uint draw_of;
layout(location = 0) out vec4 color;

void main() {
  vec4 albedo = draws[draw_of].base_color * vertex_color;
  if (draws[draw_of].textured != 0u) {
#ifdef LAMBENT_FINEST_TEXELS
    albedo *= textureLod(base_color_texture, texcoord, 0.0);  // what one ray through the pixel's centre would see
#else
    albedo *= texture(base_color_texture, texcoord);
#endif
  }
  uint mode = draws[draw_of].alpha_mode;
  if (mode == kAlphaMask && albedo.a < draws[draw_of].alpha_cutoff) discard;
  float alpha = mode == kAlphaBlend ? albedo.a : 1.0;
  color = vec4(radiance * albedo.rgb, alpha);
}
