// Projects casters orthographically, as the key light sees them, with depth 0 nearest to the light.
#include "surface_shared.h"
#include "key_shared.h"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
layout(std140, binding = kBindKeyMap) uniform MapBlock { KeyMapView map; };

layout(location = 0) in uint draw_index;
#ifdef LAMBENT_MASKED
#include "masked_caster.glsl"
#endif

void main() {
  uint at = draws[draw_index].positions_word + 3u * uint(gl_VertexID);
  vec3 position = vec3(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u]), uintBitsToFloat(geometry[at + 2u]));
  gl_Position = map.clip_from_world * (draws[draw_index].world_from_mesh * vec4(position, 1.0));
#ifdef LAMBENT_MASKED
  lookUpMask(draw_index, uint(gl_VertexID));
#endif
}
