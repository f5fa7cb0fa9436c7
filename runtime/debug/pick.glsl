// Writes which draw is visible at one pixel. Surfaces are placed as in surface.vert, with the same rule for
// cut-outs as in surface.frag. A blended surface counts where it is visible at all.
#include "surface_shared.h"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };

#ifdef LAMBENT_VERTEX
layout(location = 0) uniform mat4 clip_from_world;
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };

layout(location = 0) in uint draw_index;
layout(location = 0) flat out uint draw_of;
layout(location = 1) out vec3 looks_at;  // texture coordinates; z: the vertex colour's alpha
layout(location = 2) out vec3 normal_group;

vec2 geometry2(uint at) { return vec2(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u])); }
vec3 geometry3(uint at) { return vec3(geometry2(at), uintBitsToFloat(geometry[at + 2u])); }

void main() {
  uint vertex = uint(gl_VertexID);
  draw_of = draw_index;
  looks_at = vec3(0.0, 0.0, 1.0);
  TextureSlot slot = draws[draw_index].base_color_texture;
  if (slot.set != kAbsent) {
    uint word = slot.set == 1u ? draws[draw_index].texcoords1_word : draws[draw_index].texcoords0_word;
    looks_at.xy = slot.texture_from_coordinates * vec3(geometry2(word + 2u * vertex), 1.0);
  }
  if (draws[draw_index].colors_word != kAbsent)
    looks_at.z = unpackUnorm2x16(geometry[draws[draw_index].colors_word + 2u * vertex + 1u]).y;
  normal_group = draws[draw_index].facing *
                 (mat3(draws[draw_index].group_from_mesh_normal) * geometry3(draws[draw_index].normals_word + 3u * vertex));
  vec3 position = geometry3(draws[draw_index].positions_word + 3u * vertex);
  gl_Position = clip_from_world * (draws[draw_index].world_from_mesh * vec4(position, 1.0));
}
#else
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
#endif
