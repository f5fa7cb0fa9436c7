// Draws surfaces that compute shaders have shaded; vertices are pulled from the arenas. The receiver's part of the
// vertex stage (surface_vertex.glsl) writes what its fragment stage reads. Outputs that are never read cost nothing, because the two stages are linked together.
#include "view_block.glsl"
#include "surface_kind.glsl"
#include "surface_normal.glsl"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };

layout(location = 0) in uint draw_index;  // one per instance: the draw's base instance
layout(location = 0) flat out uint draw_of;
layout(location = 1) out vec4 looks_at;
layout(location = 2) out vec4 vertex_color;

vec2 geometry2(uint at) { return vec2(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u])); }
vec3 geometry3(uint at) { return vec3(geometry2(at), uintBitsToFloat(geometry[at + 2u])); }

// Returns the normal in the group's frame with the length of its weight. Pixels normalise the interpolated normal.
vec3 weightedNormal(uint vertex) {
  vec3 normal = geometry3(draws[draw_index].normals_word + 3u * vertex);
  return length(normal) * unit(mat3(draws[draw_index].group_from_mesh_normal) * normal);
}

// Transforms texture coordinates. This is done here and not per pixel: helper pixels beside a triangle take part in
// derivatives and mip levels, but what they read from a buffer is undefined (Mesa gives 0).
vec2 lookedAt(uint set, mat3x2 texture_from_coordinates, uint vertex) {
  uint word = set == 1u ? draws[draw_index].texcoords1_word : draws[draw_index].texcoords0_word;
  return texture_from_coordinates * vec3(geometry2(word + 2u * vertex), 1.0);
}
// This is a macro, so that nothing is read for a texture that is absent.
#define LOOKED_AT(slot) \
  (draws[draw_index].slot.set == kAbsent \
       ? vec2(0.0) \
       : lookedAt(draws[draw_index].slot.set, draws[draw_index].slot.texture_from_coordinates, vertex))

#include "surface_vertex.glsl"

void main() {
  uint vertex = uint(gl_VertexID);
  vec3 position = geometry3(draws[draw_index].positions_word + 3u * vertex);
  looks_at = vec4(LOOKED_AT(base_color_texture), LOOKED_AT(emissive_texture));
  vertex_color = vec4(1.0);
  if (draws[draw_index].colors_word != kAbsent) {
    uint at = draws[draw_index].colors_word + 2u * vertex;
    vertex_color = vec4(unpackUnorm2x16(geometry[at]), unpackUnorm2x16(geometry[at + 1u]));
  }
  writeReceiver(vertex, position);
  draw_of = draw_index;
  gl_Position = clip_from_view * (view_from_world * (draws[draw_index].world_from_mesh * vec4(position, 1.0)));
}
