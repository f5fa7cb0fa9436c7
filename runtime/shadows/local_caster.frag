// Distance from the light over its reach, the same along every ray whatever the face.
#include "surface_shared.h"
#include "local_shared.h"

layout(std140, binding = kBindShadowFace) uniform FaceBlock { ShadowFace face; };
layout(location = 0) in vec3 from_light;
#ifdef LAMBENT_MASKED
layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
#include "mask_hole.glsl"
#endif

void main() {
#ifdef LAMBENT_MASKED
  if (inHole()) discard;
#endif
  float distance_m = length(from_light);
  if (distance_m < face.hole) discard;
  // A disc's own plane, with what a lamp is made of in it, shadows nothing.
  if (face.behind > 0.0 && dot(face.direction, from_light) < 1e-3 * distance_m) discard;
  gl_FragDepth = distance_m / face.reach;
}
