// Passes on transferred light of bands 0..2 at the vertices of surfaces with a normal map, and what modules add to it
// there.
#include "tangent_vertex.glsl"

layout(std430, binding = kBindRadiance) readonly buffer Radiance { float radiance_of[]; };
layout(location = 6) out vec3 light_of_bands[kLightCoefficients];

#include "vertex_light.glsl"

void writeReceiver(uint vertex, vec3 position) {
  writeTangentFrame(vertex, position, LOOKED_AT(normal_texture));
  uint word = draws[draw_index].radiance_word + 3u * kLightCoefficients * vertex;
  for (uint j = 0u; j < kLightCoefficients; ++j) {
    uint at = word + 3u * j;
    light_of_bands[j] = vec3(radiance_of[at], radiance_of[at + 1u], radiance_of[at + 2u]);
  }
  addVertexLight(vertex, light_of_bands);
}
