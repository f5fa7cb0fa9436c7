// Passes on what the pixel needs to find the light and the lobes of a glossy surface (glossy_receiver.glsl).
#include "tangent_vertex.glsl"

layout(location = 6) out vec3 position_mesh;
layout(location = 7) out vec4 looks_at_reflection;  // texture coordinates; xy: metallic-roughness, zw: specular
layout(location = 8) out vec4 looks_at_lobes;       // texture coordinates; xy: specular colour, zw: anisotropy

void writeReceiver(uint vertex, vec3 position) {
  // Tangents follow from the coordinates of the normal map, or else from the mesh's own.
  vec2 normal_at = LOOKED_AT(normal_texture);
  if (draws[draw_index].normal_texture.set == kAbsent && draws[draw_index].texcoords0_word != kAbsent)
    normal_at = geometry2(draws[draw_index].texcoords0_word + 2u * vertex);
  writeTangentFrame(vertex, position, normal_at);
  position_mesh = position;
  looks_at_reflection =
      vec4(LOOKED_AT(glossy.metallic_roughness_texture), LOOKED_AT(glossy.specular_texture));
  looks_at_lobes = vec4(LOOKED_AT(glossy.specular_color_texture), LOOKED_AT(glossy.anisotropy_texture));
}
