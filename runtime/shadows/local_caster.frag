// Writes the distance from the light, divided by its reach. Along a ray this is the same in every face.
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
  // What lies in or behind a disc's own plane, such as the lamp's body, casts no shadow.
  if (face.behind > 0.0 && dot(face.direction, from_light) < 1e-3 * distance_m) discard;
  gl_FragDepth = distance_m / face.reach;
}
