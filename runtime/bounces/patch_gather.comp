// Gathers the light of patches. An invocation handles a vertex: it computes the mean exit radiance of the
// patches that the vertex's links go to. That is E/pi if the links are cosine-distributed; with
// LAMBENT_OUTPUTS 9 they are uniform over the hemisphere, and the result is light of bands 0..2. The luminance of the
// first output by the bands of all light follows. Its CPU twin is lighting::PatchTransport and the test beside it.
#include "patch_shared.h"

layout(local_size_x = kPatchGroupSize) in;
layout(std140, binding = kBindPatchDraw) uniform Block { PatchDraw draw; };
layout(std430, binding = kBindPatchLinks) readonly buffer Links { uint links[]; };
layout(std430, binding = kBindPatches) readonly buffer Patches { vec4 patches[]; };
layout(std430, binding = kBindPatchBounced) writeonly buffer Bounced { float bounced[]; };
#if LAMBENT_OUTPUTS > 1
layout(std430, binding = kBindPatchGeometry) readonly buffer Geometry { float geometry[]; };
layout(std430, binding = kBindPatchDirections) readonly buffer Directions { vec4 directions[]; };
#endif

const float kFrameTurnsOver = -0.37;  // as in patch_transport.hpp
const float kTwoPi = 6.2831853;

vec4 patchAt(uint vertex, uint link) {
  uint word = links[(kPatchLinks * vertex + link) >> 1u];
  return patches[draw.first_patch + ((word >> (16u * (link & 1u))) & 0xffffu)];
}

const uint kWordsPerVertex = 3u * uint(LAMBENT_OUTPUTS) + 1u;

void put(uint vertex, uint output_index, vec3 light) {
  uint at = draw.bounced_word + kWordsPerVertex * vertex + 3u * output_index;
  bounced[at] = light.r;
  bounced[at + 1u] = light.g;
  bounced[at + 2u] = light.b;
}

void putByBands(uint vertex, float light) {
  bounced[draw.bounced_word + kWordsPerVertex * (vertex + 1u) - 1u] = light;
}

void main() {
  uint vertex = gl_GlobalInvocationID.x;
  if (vertex >= draw.vertex_count) return;
#if LAMBENT_OUTPUTS == 1
  vec4 sum = vec4(0.0);
  for (uint link = 0u; link < kPatchLinks; ++link) sum += patchAt(vertex, link);
  sum /= float(kPatchLinks);
  put(vertex, 0u, sum.rgb);
  putByBands(vertex, sum.a);
#else
  uint at = draw.normals_word + 3u * vertex;
  vec3 n = normalize(mat3(draw.group_from_mesh_normal) * vec3(geometry[at], geometry[at + 1u], geometry[at + 2u]));
  float facing = n.z >= kFrameTurnsOver ? 1.0 : -1.0;
  float a = -1.0 / (facing + n.z), b = n.x * n.y * a;
  mat3 frame = mat3(vec3(1.0 + facing * n.x * n.x * a, facing * b, -facing * n.x), vec3(b, facing + n.y * n.y * a, -n.y), n);
  vec3 sums[9] = vec3[9](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
  float by_bands = 0.0;
  for (uint link = 0u; link < kPatchLinks; ++link) {
    vec3 s = frame * directions[link].xyz;
    vec4 met = kTwoPi / float(kPatchLinks) * patchAt(vertex, link);
    vec3 radiance = met.rgb;
    by_bands += 0.28209479 * met.a;
    sums[0] += 0.28209479 * radiance;
    sums[1] += 0.48860251 * s.y * radiance;
    sums[2] += 0.48860251 * s.z * radiance;
    sums[3] += 0.48860251 * s.x * radiance;
    sums[4] += 1.09254843 * s.x * s.y * radiance;
    sums[5] += 1.09254843 * s.y * s.z * radiance;
    sums[6] += 0.31539157 * (3.0 * s.z * s.z - 1.0) * radiance;
    sums[7] += 1.09254843 * s.x * s.z * radiance;
    sums[8] += 0.54627422 * (s.x * s.x - s.y * s.y) * radiance;
  }
  for (uint j = 0u; j < 9u; ++j) put(vertex, j, sums[j]);
  putByBands(vertex, by_bands);
#endif
}
