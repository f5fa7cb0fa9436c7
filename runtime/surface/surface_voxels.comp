// Marks the voxels that the triangles of a mesh pass through, with the sides that they face (lighting/probe_places.hpp), one triangle per invocation, by
// points on it that are at most half a voxel apart.
#include "reflection_probes_shared.h"

layout(local_size_x = kVoxelGroup) in;
layout(location = 0) uniform mat4 voxels_from_mesh;
layout(location = 1) uniform ivec3 voxel_count;
layout(location = 2) uniform uvec4 mesh;  // x: first word of positions, y: of indices, z: triangles, w: 1 if turned over
layout(std430, binding = kBindVoxelGeometry) readonly buffer Geometry { uint geometry[]; };
layout(std430, binding = kBindVoxelWords) buffer Words { uint words[]; };

vec3 corner(uint index) {
  uint at = mesh.x + 3u * geometry[index];
  vec3 position = uintBitsToFloat(uvec3(geometry[at], geometry[at + 1u], geometry[at + 2u]));
  return (voxels_from_mesh * vec4(position, 1.0)).xyz;
}

void main() {
  uint triangle = gl_GlobalInvocationID.x;
  if (triangle >= mesh.z) return;
  const int kMostParts = 256;
  uint first = mesh.y + 3u * triangle;
  vec3 a = corner(first), b = corner(first + 1u) - a, c = corner(first + 2u) - a;
  const float kLeastFacing = 0.3;
  vec3 normal = cross(b, c);
  float area = length(normal);
  if (!(area > 0.0)) return;
  normal *= (mesh.w != 0u ? -1.0 : 1.0) / area;
  uint sides = 0u;
  for (int axis = 0; axis < 3; ++axis)
    if (abs(normal[axis]) > kLeastFacing) sides |= 1u << (normal[axis] > 0.0 ? axis : axis + 4);
  int parts = clamp(int(ceil(2.0 * max(length(b), max(length(c), length(b - c))))), 1, kMostParts);
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j) {
      ivec3 voxel = clamp(ivec3(floor(a + (float(i) * b + float(j) * c) / float(parts))), ivec3(0), voxel_count - 1);
      uint place = uint((voxel.z * voxel_count.y + voxel.y) * voxel_count.x + voxel.x);
      atomicOr(words[place / 4u], sides << (8u * (place % 4u)));
    }
}
