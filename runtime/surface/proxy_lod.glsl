// Places a corner of a triangle that stands in for surfaces, and shades the triangle by the light at its normal,
// without shadows.
#ifdef LAMBENT_VERTEX
#include "proxy_lod_shared.h"
#include "diffuse_light.glsl"
#include "view_block.glsl"

layout(std430, binding = kBindProxyLodGroups) readonly buffer Groups { ProxyLodGroup groups[]; };
layout(std430, binding = kBindProxyLodTriangles) readonly buffer Triangles { ProxyLodTriangle triangles[]; };

layout(location = 0) flat out vec3 radiance;

vec3 cornerOf(uint triangle, uint corner) {
  return vec3(triangles[triangle].corners[3u * corner], triangles[triangle].corners[3u * corner + 1u],
              triangles[triangle].corners[3u * corner + 2u]);
}

void main() {
  uint triangle = uint(gl_VertexID) / 3u, corner = uint(gl_VertexID) % 3u;
  uint group = triangles[triangle].group;
  mat4 world_from_group = groups[group].world_from_group;
  vec3 a = (world_from_group * vec4(cornerOf(triangle, 0u), 1.0)).xyz;
  vec3 b = (world_from_group * vec4(cornerOf(triangle, 1u), 1.0)).xyz;
  vec3 c = (world_from_group * vec4(cornerOf(triangle, 2u), 1.0)).xyz;
  // A mirrored group reverses its winding.
  if (determinant(mat3(world_from_group)) < 0.0) {
    vec3 swapped = b;
    b = c;
    c = swapped;
  }
  vec3 across = cross(b - a, c - a);
  float size = length(across);
  vec3 normal = size > 0.0 ? across / size : vec3(0.0, 1.0, 0.0);
  vec3 light[9] = vec3[9](groups[group].light[0].rgb, groups[group].light[1].rgb, groups[group].light[2].rgb,
                          groups[group].light[3].rgb, groups[group].light[4].rgb, groups[group].light[5].rgb,
                          groups[group].light[6].rgb, groups[group].light[7].rgb, groups[group].light[8].rgb);
  vec3 reflectance = vec3(triangles[triangle].reflectance[0], triangles[triangle].reflectance[1],
                          triangles[triangle].reflectance[2]);
  vec3 emission =
      vec3(triangles[triangle].emission[0], triangles[triangle].emission[1], triangles[triangle].emission[2]);
  radiance = reflectance * max(diffuseLight(light, normal), vec3(0.0)) + emission;
  vec3 position = corner == 0u ? a : corner == 1u ? b : c;
  gl_Position = clip_from_view * (view_from_world * vec4(position, 1.0));
}
#else
layout(location = 0) flat in vec3 radiance;
layout(location = 0) out vec4 color;

void main() {
  color = vec4(radiance, 1.0);
}
#endif
