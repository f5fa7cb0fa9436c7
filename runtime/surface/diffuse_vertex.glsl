// Passes on E/pi at the vertices as the diffuse effect computed it, and what modules add to it there.
layout(std430, binding = kBindRadiance) readonly buffer Radiance { float radiance_of[]; };
layout(location = 3) out vec3 radiance;
layout(location = 3, component = 3) out float straight;  // as of a SurfacePoint
layout(location = 4) out vec3 normal_group;  // on the visible side
layout(location = 5) out vec3 position_mesh;
layout(location = 7) out vec3 stored_radiance;  // what texels replace, see texel_light.glsl
layout(location = 8) out vec2 irradiance_at;
#ifdef LAMBENT_GLOSSY
layout(location = 6) out vec4 looks_at_reflection;  // texture coordinates of the layer; xy: metallic-roughness
#endif

const float kAllStraight = 1e4;  // as of vertices without transfer (diffuse_eval.glsl)

#include "vertex_light.glsl"

void writeReceiver(uint vertex, vec3 position) {
  radiance = vec3(0.0);
  straight = kAllStraight;
  if (!kDark) {
    uint at = draws[draw_index].radiance_word + 4u * vertex;
    radiance = vec3(radiance_of[at], radiance_of[at + 1u], radiance_of[at + 2u]);
    straight = radiance_of[at + 3u];
  }
  stored_radiance = radiance;
  irradiance_at = kHasTexels ? lookedAt(draws[draw_index].irradiance_set, mat3x2(1.0), vertex) : vec2(0.0);
  addVertexLight(vertex, radiance);
  normal_group = draws[draw_index].facing * weightedNormal(vertex);
  position_mesh = position;
#ifdef LAMBENT_GLOSSY
  looks_at_reflection = vec4(LOOKED_AT(glossy.metallic_roughness_texture), 0.0, 0.0);
#endif
}
