// Writes what the receiver's part of the fragment stage reads of the vertices, and what modules add there.
#include "vertex_light.glsl"

#if defined(LAMBENT_NORMAL_MAPPED) || (defined(LAMBENT_GLOSSY) && !defined(LAMBENT_LAYERED))
// Writes what mapped_normal.glsl reads. Together with the light of normal-mapped surfaces and what a layer reads this
// uses all fifteen locations that OpenGL 4.5 promises.
layout(location = 3) out vec4 position_group;
layout(location = 4) out vec4 normal_group;
layout(location = 5) out vec4 tangent_group;

void writeTangentFrame(uint vertex, vec3 position, vec2 normal_at) {
  mat3 group_from_mesh = mat3(draws[draw_index].group_from_mesh);
  position_group = vec4(group_from_mesh * position, normal_at.x);
  normal_group = vec4(weightedNormal(vertex), normal_at.y);
  tangent_group = vec4(0.0);
  if (draws[draw_index].tangents_word != kAbsent) {
    uint at = draws[draw_index].tangents_word + 4u * vertex;
    // A mirrored node mirrors the bitangent, but a cross product of transformed vectors would not.
    float mirrored = determinant(group_from_mesh) < 0.0 ? -1.0 : 1.0;
    tangent_group = vec4(group_from_mesh * geometry3(at), mirrored * uintBitsToFloat(geometry[at + 3u]));
  }
}
#endif

#if defined(LAMBENT_GLOSSY) && !defined(LAMBENT_LAYERED)
// Glossy surfaces: what the pixel needs to find the light and the lobes (glossy_receiver.glsl).
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

#elif defined(LAMBENT_NORMAL_MAPPED)
// Surfaces with a normal map: transferred light of bands 0..2.
layout(std430, binding = kBindRadiance) readonly buffer Radiance { float radiance_of[]; };
layout(location = 6) out vec4 packed_light[7];  // see lightOfBands()
#ifdef LAMBENT_GLOSSY
layout(location = 13) out vec4 looks_at_reflection;  // texture coordinates of the layer; xy: metallic-roughness
layout(location = 14) out vec3 position_mesh;
#endif

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

#else
// Others: E/pi as the diffuse effect computed it.
layout(std430, binding = kBindRadiance) readonly buffer Radiance { float radiance_of[]; };
layout(location = 3) out vec3 radiance;
layout(location = 3, component = 3) out float straight;  // as of a SurfacePoint
layout(location = 4) out vec3 normal_group;  // on the visible side
layout(location = 5) out vec3 position_mesh;
layout(location = 7) out vec3 stored_radiance;  // what texels replace, see transferredLight()
layout(location = 8) out vec2 irradiance_at;
#ifdef LAMBENT_GLOSSY
layout(location = 6) out vec4 looks_at_reflection;  // texture coordinates of the layer; xy: metallic-roughness
#endif

const float kAllStraight = 1e4;  // as of vertices without transfer (diffuse_eval.glsl)

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
#endif
