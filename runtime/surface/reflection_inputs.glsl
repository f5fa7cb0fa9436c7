// Declares what a surface that reflects reads at a pixel: its textures, its table, the corners of the triangle and the
// direction to the eye; and includes the kernel of the table (glossy_kernel.glsl). The receiver declares
// looks_at_reflection and looks_at_lobes, the coordinates in these textures (surface_vertex.glsl).
#include "view_block.glsl"

layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
layout(binding = kUnitMetallicRoughness) uniform sampler2D metallic_roughness_texture;
#ifndef LAMBENT_LAYERED
layout(binding = kUnitSpecular) uniform sampler2D specular_texture;
layout(binding = kUnitSpecularColor) uniform sampler2D specular_color_texture;
#ifdef LAMBENT_ANISOTROPIC
layout(binding = kUnitAnisotropy) uniform sampler2D anisotropy_texture;
#endif
#endif
layout(binding = kUnitBrdf) uniform sampler2DArray brdf_table;

#include "glossy_kernel.glsl"

uvec2 brdfNodes() { return uvec2(textureSize(brdf_table, 0).xy); }
vec4 brdfTexel(vec2 place, uint layer) {
  return textureLod(brdf_table, vec3((place + 0.5) / vec2(textureSize(brdf_table, 0).xy), float(layer)), 0.0);
}

vec3 cornerPosition(uint corner) {
  uint at = draws[draw_of].positions_word + 3u * corner;
  return vec3(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u]), uintBitsToFloat(geometry[at + 2u]));
}

uvec3 triangleCorners() {
  uint first = draws[draw_of].glossy.indices_word + 3u * uint(gl_PrimitiveID);
  return uvec3(geometry[first], geometry[first + 1u], geometry[first + 2u]);
}

// Returns the pixel's weights of the corners, from its position in the mesh.
vec3 weightsOf(uvec3 corners, vec3 position) {
  return cornerWeights(position, cornerPosition(corners.x), cornerPosition(corners.y), cornerPosition(corners.z));
}

// Returns the unit direction towards the eye from a position in the mesh, in the group's frame.
vec3 towardsEye(vec3 position) {
  vec3 position_ws = (draws[draw_of].world_from_mesh * vec4(position, 1.0)).xyz;
  return unit(mat3(draws[draw_of].glossy.group_from_world) * (eye.xyz - eye.w * position_ws));
}

// These hold values of the pixel that is being shaded, for modules.
LocalView pixel_view = LocalView(vec3(0.0), vec3(0.0), vec3(0.0), 0.0, vec2(0.0));
vec4 pixel_weights[kTexels];

// Sets the view of this pixel and its weights of the table. It stands above everything that reads them, because
// compilers warn of variables that are read in a function above the one that sets them.
void lookFrom(vec3 normal, vec3 tangent, vec3 to_eye, float roughness, float anisotropy, uvec2 nodes) {
  pixel_view = localView(normal, tangent, to_eye);
  lookUpWeights(pixel_view, roughness, anisotropy, nodes, pixel_weights);
}
