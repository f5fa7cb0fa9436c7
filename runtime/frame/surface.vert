// Surfaces: vertices are pulled from the arenas; shading was done in compute.
#include "surface_shared.h"

layout(std140, binding = kBindView) uniform ViewBlock { mat4 view_from_world; mat4 clip_from_view; };
layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
layout(std430, binding = kBindRadiance) readonly buffer Radiance { float radiance_of[]; };

layout(location = 0) in uint draw_index;  // one per instance: the draw's base instance
layout(location = 0) out vec3 radiance;
layout(location = 1) out vec2 texcoord;
layout(location = 2) out vec4 vertex_color;
layout(location = 3) flat out uint draw_of;

void main() {
  SurfaceDraw draw = draws[draw_index];
  uint vertex = uint(gl_VertexID);
  uint at = draw.positions_word + 3u * vertex;
  vec3 position = vec3(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u]),
                       uintBitsToFloat(geometry[at + 2u]));
  at = draw.radiance_word + 3u * vertex;
  radiance = vec3(radiance_of[at], radiance_of[at + 1u], radiance_of[at + 2u]);
  texcoord = vec2(0.0);
  if (draw.texcoords_word != kAbsent) {
    at = draw.texcoords_word + 2u * vertex;
    texcoord = vec2(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u]));
  }
  vertex_color = vec4(1.0);
  if (draw.colors_word != kAbsent) {
    at = draw.colors_word + 2u * vertex;
    vertex_color = vec4(unpackUnorm2x16(geometry[at]), unpackUnorm2x16(geometry[at + 1u]));
  }
  draw_of = draw_index;
  gl_Position = clip_from_view * (view_from_world * (draw.world_from_mesh * vec4(position, 1.0)));
}
