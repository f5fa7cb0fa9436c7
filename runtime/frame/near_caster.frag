// Distance from the light over its reach, the same along every ray whatever the face.
#include "surface_shared.h"
#include "near_shared.h"

layout(std140, binding = kBindShadowFace) uniform FaceBlock { ShadowFace face; };
layout(location = 0) in vec3 from_light;
#ifdef LAMBENT_MASKED
layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(binding = kUnitBaseColor) uniform sampler2D base_color_texture;
layout(location = 1) flat in uint draw_of;
layout(location = 2) in vec3 looks_at;
#endif

void main() {
#ifdef LAMBENT_MASKED
  float alpha = draws[draw_of].base_color.a * looks_at.z;
  if (draws[draw_of].base_color_texture.set != kAbsent) alpha *= texture(base_color_texture, looks_at.xy).a;
  if (alpha < draws[draw_of].alpha_cutoff) discard;
#endif
  float distance_m = length(from_light);
  if (distance_m < face.hole) discard;
  // A disc's own plane, with what a lamp is made of in it, shadows nothing.
  if (face.behind > 0.0 && dot(face.direction, from_light) < 1e-3 * distance_m) discard;
  gl_FragDepth = distance_m / face.reach;
}
