// Writes depth only, as a shadow map needs; masked surfaces leave holes.
#ifdef LAMBENT_MASKED
#include "surface_shared.h"
layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
#include "mask_hole.glsl"
#endif

void main() {
#ifdef LAMBENT_MASKED
  if (inHole()) discard;
#endif
}
