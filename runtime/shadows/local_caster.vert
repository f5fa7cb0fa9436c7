// Projects casters onto one face of a local light's shadow cube, as seen from the light's centre.
#include "surface_shared.h"
#include "local_shared.h"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
layout(std140, binding = kBindShadowFace) uniform FaceBlock { ShadowFace face; };

layout(location = 0) in uint draw_index;
layout(location = 0) out vec3 from_light;
#ifdef LAMBENT_MASKED
#include "masked_caster.glsl"
#endif

vec2 geometry2(uint at) { return vec2(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u])); }

void main() {
  SurfaceDraw draw = draws[draw_index];
  uint vertex = uint(gl_VertexID);
  uint at = draw.positions_word + 3u * vertex;
  vec3 position = vec3(geometry2(at), uintBitsToFloat(geometry[at + 2u]));
  from_light = (draw.world_from_mesh * vec4(position, 1.0)).xyz - face.position;
#ifdef LAMBENT_MASKED
  lookUpMask(draw_index, vertex);
#endif
  // There is no far plane; the fragment stage writes depth.
  float ahead = dot(face.forward, from_light);
  gl_Position = vec4(dot(face.right, from_light), dot(face.up, from_light), ahead - 2.0 * face.clip_near, ahead);
}
