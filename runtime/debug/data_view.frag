// Draws a number as a colour, or the wires of triangles. With LAMBENT_FINEST_TEXELS, for pictures that are
// compared, it writes the number itself to all channels, or for clusters the cluster, the cell and 0. Alpha
// is coverage, for wires that of the wires.
#include "surface_shared.h"
#include "transfer_values_shared.h"
#include "view_colors.glsl"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(binding = kUnitBaseColor) uniform sampler2D base_color_texture;
layout(location = 0) uniform uint draw_index;
layout(location = 1) uniform vec2 range;
layout(location = 2) uniform vec4 wire_color;

layout(location = 0) in vec3 barycentric;
layout(location = 1) in vec3 position_vs;
layout(location = 2) in vec2 looks_at;
layout(location = 3) in float vertex_alpha;
layout(location = 4) in vec2 value;
layout(location = 5) flat in uvec3 clusters;
layout(location = 0) out vec4 color;

// Surfaces without a number are grey, lit from the eye so that their shape can be seen.
vec3 withoutValue() {
  vec3 normal = normalize(cross(dFdx(position_vs), dFdy(position_vs)));
  return vec3(0.16 + 0.16 * abs(dot(normal, normalize(position_vs))));
}

vec4 wires() {
  // Distances to the edges are in pixels. Wires of triangles as small as pixels would fill the picture, so
  // they fade to a veil.
  vec3 per_pixel = fwidth(barycentric);
  vec3 distance_px = barycentric / max(per_pixel, vec3(1e-6));
  float nearest = min(distance_px.x, min(distance_px.y, distance_px.z));
  float line = 1.0 - smoothstep(0.35, 1.1, nearest);
  float crowd = max(per_pixel.x, max(per_pixel.y, per_pixel.z));
  return vec4(wire_color.rgb, wire_color.a * line * mix(1.0, 0.3, smoothstep(0.12, 0.5, crowd)));
}

void main() {
  vec3 grey = withoutValue();
  if (draws[draw_index].alpha_mode == kAlphaMask) {
    float alpha = draws[draw_index].base_color.a * vertex_alpha;
    if (draws[draw_index].base_color_texture.set != kAbsent) alpha *= textureLod(base_color_texture, looks_at, 0.0).a;
    if (alpha < draws[draw_index].alpha_cutoff) discard;
  }
#if defined(LAMBENT_WIRES)
  color = wires();
  if (color.a == 0.0) discard;
  color.rgb *= color.a;
#elif defined(LAMBENT_CLUSTERS)
  uint nearest = barycentric.x >= max(barycentric.y, barycentric.z) ? 0u : barycentric.y >= barycentric.z ? 1u : 2u;
  uint cluster = clusters[nearest];
#ifdef LAMBENT_FINEST_TEXELS
  color = cluster == kNoCluster ? vec4(-1.0, -1.0, 0.0, 1.0) : vec4(float(cluster & 0xffffu), float(cluster >> 16u), 0.0, 1.0);
#else
  color = vec4(displayed(cluster == kNoCluster ? grey : distinctColor(cluster)), 1.0);
#endif
#else
  bool known = value.y > 1e-3;
  float number = value.x / max(value.y, 1e-3);
#ifdef LAMBENT_FINEST_TEXELS
  color = vec4(vec3(known ? number : -1.0), 1.0);
#else
  color = vec4(displayed(known ? viridis((number - range.x) / (range.y - range.x)) : grey), 1.0);
#endif
#endif
}
