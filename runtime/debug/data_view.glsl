// Draws a number of a sample as a colour, the wires of triangles, or which draw is visible at one pixel: corner by
// corner, without an index buffer, so that each corner knows the other two. With LAMBENT_FINEST_TEXELS, for pictures
// that are compared, it writes the number itself to all channels, or for clusters the cluster, the cell and 0. Alpha is
// coverage, for wires that of the wires.
#include "surface_shared.h"
#include "transfer_values_shared.h"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(location = 0) uniform uint draw_index;

#ifdef LAMBENT_VERTEX
#include "view_block.glsl"
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
layout(std430, binding = 3) readonly buffer Rows { uint rows[]; };
layout(std430, binding = 4) readonly buffer Values { SampleValue values[]; };
// The draw's rows, laid out as for glossy draws: first word (kAbsent: none), entries, vertices; w: first word of indices.
layout(location = 3) uniform uvec4 rows_of_draw;
layout(location = 4) uniform uint first_value;  // index of the value of sample 0 of its rows
layout(location = 0) out vec3 barycentric;
layout(location = 1) out vec3 position_vs;
layout(location = 2) out vec2 looks_at;
layout(location = 3) out float vertex_alpha;
layout(location = 4) out vec2 value;  // value times the share of samples that have one, and that share
layout(location = 5) flat out uvec3 clusters;
layout(location = 6) out vec3 normal_group;

vec2 geometry2(uint at) { return vec2(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u])); }
vec3 geometry3(uint at) { return vec3(geometry2(at), uintBitsToFloat(geometry[at + 2u])); }

#ifdef LAMBENT_VALUES
// Computes the mean over the vertex's samples, and returns the cluster of the sample with the largest weight.
uint gather(uint vertex, out vec2 mean) {
  mean = vec2(0.0);
  uint first_row = rows_of_draw.x;
  if (first_row == kAbsent) return kNoCluster;
  uint samples_word = first_row + rows_of_draw.z + 1u, weights_word = samples_word + rows_of_draw.y;
  uint end = rows[first_row + vertex + 1u], cluster = kNoCluster;
  float total = 0.0, most = 0.0;
  for (uint entry = rows[first_row + vertex]; entry < end; ++entry) {
    uint pair = rows[weights_word + (entry >> 1u)];
    float weight = float((pair >> (16u * (entry & 1u))) & 0xffffu) / 65535.0;
    SampleValue one = values[first_value + rows[samples_word + entry]];
    total += weight;
    if (one.cluster == kNoCluster) continue;
    mean += weight * vec2(uintBitsToFloat(one.value_bits), 1.0);
    if (weight > most) {
      most = weight;
      cluster = one.cluster;
    }
  }
  if (total > 0.0) mean /= total;
  return cluster;
}
#endif

void main() {
  uint corner = uint(gl_VertexID) % 3u, first = rows_of_draw.w + uint(gl_VertexID) - corner;
  uint vertex = geometry[first + corner];
  barycentric = vec3(corner == 0u, corner == 1u, corner == 2u);
  value = vec2(0.0);
  clusters = uvec3(kNoCluster);
#ifdef LAMBENT_VALUES
  vec2 other;
  for (uint c = 0u; c < 3u; ++c) {
    uint cluster = gather(geometry[first + c], other);
    clusters[c] = cluster;
    if (c == corner) value = other;
  }
#endif
  looks_at = vec2(0.0);
  if (draws[draw_index].base_color_texture.set != kAbsent) {
    uint word = draws[draw_index].base_color_texture.set == 1u ? draws[draw_index].texcoords1_word : draws[draw_index].texcoords0_word;
    looks_at = draws[draw_index].base_color_texture.texture_from_coordinates * vec3(geometry2(word + 2u * vertex), 1.0);
  }
  vertex_alpha = 1.0;
  if (draws[draw_index].colors_word != kAbsent)
    vertex_alpha = unpackUnorm2x16(geometry[draws[draw_index].colors_word + 2u * vertex + 1u]).y;
  normal_group = draws[draw_index].facing *
                 (mat3(draws[draw_index].group_from_mesh_normal) * geometry3(draws[draw_index].normals_word + 3u * vertex));
  vec4 place = view_from_world * (draws[draw_index].world_from_mesh * vec4(geometry3(draws[draw_index].positions_word + 3u * vertex), 1.0));
  position_vs = place.xyz;
  gl_Position = clip_from_view * place;
}
#else
#include "view_colors.glsl"

layout(binding = kUnitBaseColor) uniform sampler2D base_color_texture;
layout(location = 1) uniform vec2 range;
layout(location = 2) uniform vec4 wire_color;

layout(location = 0) in vec3 barycentric;
layout(location = 1) in vec3 position_vs;
layout(location = 2) in vec2 looks_at;
layout(location = 3) in float vertex_alpha;
layout(location = 4) in vec2 value;
layout(location = 5) flat in uvec3 clusters;
layout(location = 6) in vec3 normal_group;

#ifdef LAMBENT_PICKED
layout(location = 0) out uvec4 seen;

// Cut-outs follow the same rule as in surface.frag. A blended surface counts where it is visible at all.
void main() {
  const float kLeastSeen = 0.5 / 255.0;
#ifdef LAMBENT_FINEST_TEXELS
  float texel = textureLod(base_color_texture, looks_at, 0.0).a;
#else
  float texel = texture(base_color_texture, looks_at).a;
#endif
  float alpha = draws[draw_index].base_color.a * vertex_alpha;
  if (draws[draw_index].base_color_texture.set != kAbsent) alpha *= texel;
  uint mode = draws[draw_index].alpha_mode;
  if (mode == kAlphaMask && alpha < draws[draw_index].alpha_cutoff) discard;
  if (mode == kAlphaBlend && alpha < kLeastSeen) discard;
  seen = uvec4(draw_index, floatBitsToUint(normal_group));
}
#else
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
#endif
#endif
