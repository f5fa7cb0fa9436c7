// Surfaces: vertices are pulled from the arenas; shading was done in compute.
#include "surface_shared.h"

layout(std140, binding = kBindView) uniform ViewBlock {
  mat4 view_from_world;
  mat4 clip_from_view;
  vec4 eye;  // of glossy_surface.glsl
};
layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
#if !defined(LAMBENT_GLOSSY) && !defined(LAMBENT_DARK)
layout(std430, binding = kBindRadiance) readonly buffer Radiance { float radiance_of[]; };
#endif

#ifdef LAMBENT_VERTEX_CHANGE
#include "neighborhood_shared.h"
layout(std430, binding = kBindReceivers) readonly buffer Receivers { Receiver receivers[]; };
layout(std430, binding = kBindRadianceChange) readonly buffer RadianceChange { float change_of[]; };
#endif

layout(location = 0) in uint draw_index;  // one per instance: the draw's base instance
layout(location = 0) flat out uint draw_of;
layout(location = 1) out vec4 looks_at;  // in the base colour picture: xy; in the emissive one: zw
layout(location = 2) out vec4 vertex_color;
#if defined(LAMBENT_NORMAL_MAPPED) || defined(LAMBENT_SHADOWED_LIGHTS) || defined(LAMBENT_KEY_LIGHTS) || defined(LAMBENT_GLOSSY) || defined(LAMBENT_NEIGHBORHOODS) || defined(LAMBENT_VIEW_NORMALS)
#include "surface_normal.glsl"
#endif
#if defined(LAMBENT_NORMAL_MAPPED) || defined(LAMBENT_GLOSSY)
// In the group's frame. With those of normal maps all fifteen locations that OpenGL 4.5 promises are in use.
layout(location = 3) out vec4 position_group;  // w, and that of the normal: where in the normal picture
layout(location = 4) out vec4 normal_group;
layout(location = 5) out vec4 tangent_group;  // w: +1 or -1 as glTF has it, of the mesh as it stands in the group
#ifdef LAMBENT_GLOSSY
layout(location = 6) out vec3 position_mesh;
layout(location = 7) out vec4 looks_at_reflection;  // in the metallic-roughness picture: xy; specular: zw
layout(location = 8) out vec4 looks_at_lobes;       // specular colour: xy; anisotropy: zw
#else
layout(location = 6) out vec3 light[kLightCoefficients];
#endif
#else
layout(location = 3) out vec3 radiance;
#if defined(LAMBENT_SHADOWED_LIGHTS) || defined(LAMBENT_KEY_LIGHTS) || defined(LAMBENT_NEIGHBORHOODS) || defined(LAMBENT_VIEW_NORMALS)
layout(location = 4) out vec3 normal_group;  // of the side that is seen
#endif
#ifdef LAMBENT_NEIGHBORHOODS
layout(location = 5) out vec3 position_mesh;
#endif
#endif

#if defined(LAMBENT_BOUNCES) && !defined(LAMBENT_GLOSSY)
layout(std430, binding = kBindBounced) readonly buffer Bounced { float bounced_of[]; };
vec3 bouncedAt(uint place) {
  uint at = draws[draw_index].bounced_word + 3u * place;
  return vec3(bounced_of[at], bounced_of[at + 1u], bounced_of[at + 2u]);
}
#endif

vec2 geometry2(uint at) { return vec2(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u])); }
vec3 geometry3(uint at) { return vec3(geometry2(at), uintBitsToFloat(geometry[at + 2u])); }
// In the group's frame, as long as its weight: pixels bring what is between to unit length.
#if defined(LAMBENT_NORMAL_MAPPED) || defined(LAMBENT_SHADOWED_LIGHTS) || defined(LAMBENT_KEY_LIGHTS) || defined(LAMBENT_GLOSSY) || defined(LAMBENT_NEIGHBORHOODS) || defined(LAMBENT_VIEW_NORMALS)
vec3 weightedNormal(uint vertex) {
  vec3 normal = geometry3(draws[draw_index].normals_word + 3u * vertex);
  return length(normal) * unit(mat3(draws[draw_index].group_from_mesh_normal) * normal);
}
#endif
#if !defined(LAMBENT_GLOSSY) && !defined(LAMBENT_DARK)
vec3 radianceAt(uint at) { return vec3(radiance_of[at], radiance_of[at + 1u], radiance_of[at + 2u]); }
#endif

// Done here, not per pixel: pixels beside a triangle have their part in its derivatives and mip levels, but what they
// read of a buffer need not be there (Mesa gives 0).
vec2 lookedAt(uint set, mat3x2 texture_from_coordinates, uint vertex) {
  uint word = set == 1u ? draws[draw_index].texcoords1_word : draws[draw_index].texcoords0_word;
  return texture_from_coordinates * vec3(geometry2(word + 2u * vertex), 1.0);
}
// A macro, so that nothing is read of a texture that is absent.
#define LOOKED_AT(slot) \
  (draws[draw_index].slot.set == kAbsent \
       ? vec2(0.0) \
       : lookedAt(draws[draw_index].slot.set, draws[draw_index].slot.texture_from_coordinates, vertex))

void main() {
  uint vertex = uint(gl_VertexID);
  vec3 position = geometry3(draws[draw_index].positions_word + 3u * vertex);
  looks_at = vec4(LOOKED_AT(base_color_texture), LOOKED_AT(emissive_texture));
  vertex_color = vec4(1.0);
  if (draws[draw_index].colors_word != kAbsent) {
    uint at = draws[draw_index].colors_word + 2u * vertex;
    vertex_color = vec4(unpackUnorm2x16(geometry[at]), unpackUnorm2x16(geometry[at + 1u]));
  }
#if defined(LAMBENT_NORMAL_MAPPED) || defined(LAMBENT_GLOSSY)
  mat3 group_from_mesh = mat3(draws[draw_index].group_from_mesh);
  vec3 normal = weightedNormal(vertex);
  vec2 normal_at = LOOKED_AT(normal_texture);
#ifdef LAMBENT_GLOSSY
  // Tangents follow from the normal map's coordinates or else from the mesh's own.
  if (draws[draw_index].normal_texture.set == kAbsent && draws[draw_index].texcoords0_word != kAbsent)
    normal_at = geometry2(draws[draw_index].texcoords0_word + 2u * vertex);
  position_mesh = position;
  looks_at_reflection =
      vec4(LOOKED_AT(glossy.metallic_roughness_texture), LOOKED_AT(glossy.specular_texture));
  looks_at_lobes = vec4(LOOKED_AT(glossy.specular_color_texture), LOOKED_AT(glossy.anisotropy_texture));
#endif
  position_group = vec4(group_from_mesh * position, normal_at.x);
  normal_group = vec4(normal, normal_at.y);
  tangent_group = vec4(0.0);
  if (draws[draw_index].tangents_word != kAbsent) {
    uint at = draws[draw_index].tangents_word + 4u * vertex;
    // A mirrored node mirrors the bitangent, which a cross product of turned vectors would not.
    float mirrored = determinant(group_from_mesh) < 0.0 ? -1.0 : 1.0;
    tangent_group = vec4(group_from_mesh * geometry3(at), mirrored * uintBitsToFloat(geometry[at + 3u]));
  }
#ifndef LAMBENT_GLOSSY
  uint words = 3u * kLightCoefficients;
  for (uint j = 0u; j < kLightCoefficients; ++j) light[j] = radianceAt(draws[draw_index].radiance_word + words * vertex + 3u * j);
#ifdef LAMBENT_BOUNCES
  for (uint j = 0u; j < kLightCoefficients; ++j) light[j] += bouncedAt(kLightCoefficients * vertex + j);
#endif
#endif
#elif defined(LAMBENT_DARK)
  radiance = vec3(0.0);
#else
  radiance = radianceAt(draws[draw_index].radiance_word + 3u * vertex);
#ifdef LAMBENT_VERTEX_CHANGE
  uint change_at = receivers[draw_index].change_word + 3u * vertex;
  // As withChange in neighborhood_eval.glsl.
  radiance = max(radiance + vec3(change_of[change_at], change_of[change_at + 1u], change_of[change_at + 2u]),
                 min(radiance, vec3(0.0)));
#endif
#ifdef LAMBENT_BOUNCES
  radiance += bouncedAt(vertex);
#endif
#if defined(LAMBENT_SHADOWED_LIGHTS) || defined(LAMBENT_KEY_LIGHTS) || defined(LAMBENT_NEIGHBORHOODS) || defined(LAMBENT_VIEW_NORMALS)
  normal_group =
      draws[draw_index].facing * weightedNormal(vertex);
#endif
#ifdef LAMBENT_NEIGHBORHOODS
  position_mesh = position;
#endif
#endif
  draw_of = draw_index;
  gl_Position = clip_from_view * (view_from_world * (draws[draw_index].world_from_mesh * vec4(position, 1.0)));
}
