// Writes which draw is visible, with the same rule for cut-outs as surface.frag. A blended surface counts
// where it is visible at all.
#include "surface_shared.h"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(binding = kUnitBaseColor) uniform sampler2D base_color_texture;
layout(location = 0) flat in uint draw_of;
layout(location = 1) in vec3 looks_at;
layout(location = 2) in vec3 normal_group;
layout(location = 0) out uvec4 seen;

const float kLeastSeen = 0.5 / 255.0;

void main() {
#ifdef LAMBENT_FINEST_TEXELS
  float texel = textureLod(base_color_texture, looks_at.xy, 0.0).a;
#else
  float texel = texture(base_color_texture, looks_at.xy).a;
#endif
  float alpha = draws[draw_of].base_color.a * looks_at.z;
  if (draws[draw_of].base_color_texture.set != kAbsent) alpha *= texel;
  uint mode = draws[draw_of].alpha_mode;
  if (mode == kAlphaMask && alpha < draws[draw_of].alpha_cutoff) discard;
  if (mode == kAlphaBlend && alpha < kLeastSeen) discard;
  seen = uvec4(draw_of, floatBitsToUint(normal_group));
}
