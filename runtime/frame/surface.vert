// Surfaces: vertices are pulled from the arenas; shading was done in compute.
#include "surface_shared.h"

layout(std140, binding = kBindView) uniform ViewBlock { mat4 view_from_world; mat4 clip_from_view; };
layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
layout(std430, binding = kBindRadiance) readonly buffer Radiance { float radiance_of[]; };

layout(location = 0) in uint draw_index;  // one per instance: the draw's base instance
layout(location = 0) flat out uint draw_of;
layout(location = 1) out vec4 coordinates;  // TEXCOORD_0 and TEXCOORD_1
layout(location = 2) out vec4 vertex_color;
#ifdef LAMBENT_NORMAL_MAPPED
// In the group's frame. With them all fifteen locations that OpenGL 4.5 promises are in use.
layout(location = 3) out vec3 position_group;
layout(location = 4) out vec3 normal_group;
layout(location = 5) out vec4 tangent_group;  // w: +1 or -1 as glTF has it, of the mesh as it stands in the group
layout(location = 6) out vec3 light[kLightCoefficients];
#else
layout(location = 3) out vec3 radiance;
#endif

vec2 geometry2(uint at) { return vec2(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u])); }
vec3 geometry3(uint at) { return vec3(geometry2(at), uintBitsToFloat(geometry[at + 2u])); }
vec2 coordinatesAt(uint word, uint vertex) { return word == kAbsent ? vec2(0.0) : geometry2(word + 2u * vertex); }
vec3 radianceAt(uint at) { return vec3(radiance_of[at], radiance_of[at + 1u], radiance_of[at + 2u]); }

void main() {
  SurfaceDraw draw = draws[draw_index];
  uint vertex = uint(gl_VertexID);
  vec3 position = geometry3(draw.positions_word + 3u * vertex);
  coordinates = vec4(coordinatesAt(draw.texcoords0_word, vertex), coordinatesAt(draw.texcoords1_word, vertex));
  vertex_color = vec4(1.0);
  if (draw.colors_word != kAbsent) {
    uint at = draw.colors_word + 2u * vertex;
    vertex_color = vec4(unpackUnorm2x16(geometry[at]), unpackUnorm2x16(geometry[at + 1u]));
  }
#ifdef LAMBENT_NORMAL_MAPPED
  mat3 group_from_mesh = mat3(draw.group_from_mesh);
  position_group = group_from_mesh * position;
  normal_group = normalize(mat3(draw.group_from_mesh_normal) * geometry3(draw.normals_word + 3u * vertex));
  tangent_group = vec4(0.0);
  if (draw.tangents_word != kAbsent) {
    uint at = draw.tangents_word + 4u * vertex;
    // A mirrored node mirrors the bitangent, which a cross product of turned vectors would not.
    float mirrored = determinant(group_from_mesh) < 0.0 ? -1.0 : 1.0;
    tangent_group = vec4(group_from_mesh * geometry3(at), mirrored * uintBitsToFloat(geometry[at + 3u]));
  }
  uint words = 3u * kLightCoefficients;
  for (uint j = 0u; j < kLightCoefficients; ++j) light[j] = radianceAt(draw.radiance_word + words * vertex + 3u * j);
#else
  radiance = radianceAt(draw.radiance_word + 3u * vertex);
#endif
  draw_of = draw_index;
  gl_Position = clip_from_view * (view_from_world * (draw.world_from_mesh * vec4(position, 1.0)));
}
