// Passes on transferred light of bands 0..2 at the vertices of surfaces with a normal map, and what modules add to it
// there.
#include "tangent_vertex.glsl"

layout(std430, binding = kBindRadiance) readonly buffer Radiance { float radiance_of[]; };
layout(location = 6) out vec4 packed_light[7];  // see packed_light.glsl
#ifdef LAMBENT_GLOSSY
layout(location = 13) out vec4 looks_at_reflection;  // texture coordinates of the layer; xy: metallic-roughness
layout(location = 14) out vec3 position_mesh;
#endif

#include "vertex_light.glsl"

void writeReceiver(uint vertex, vec3 position) {
  writeTangentFrame(vertex, position, LOOKED_AT(normal_texture));
  uint word = draws[draw_index].radiance_word + 3u * kLightCoefficients * vertex;
  vec3 light_of_bands[kLightCoefficients];
  for (uint j = 0u; j < kLightCoefficients; ++j) {
    uint at = word + 3u * j;
    light_of_bands[j] = vec3(radiance_of[at], radiance_of[at + 1u], radiance_of[at + 2u]);
  }
  addVertexLight(vertex, light_of_bands);
  packed_light[6] = vec4(0.0);
  for (int i = 0; i < 27; ++i) packed_light[i / 4][i % 4] = light_of_bands[i / 3][i % 3];
#ifdef LAMBENT_GLOSSY
  looks_at_reflection = vec4(LOOKED_AT(glossy.metallic_roughness_texture), 0.0, 0.0);
  position_mesh = position;
#endif
}
