// Draws a plane through the grid of a neighborhood, corner by corner.
#include "surface_shared.h"
#include "overlay_slice_shared.h"

layout(std140, binding = kBindView) uniform ViewBlock {
  mat4 view_from_world;
  mat4 clip_from_view;
  vec4 eye;
};
layout(std430, binding = kBindSlices) readonly buffer Slices { SliceRecord slices[]; };
layout(location = 0) out vec3 place;  // in units of grid points
layout(location = 1) flat out int slice;

void main() {
  const vec2 kCorners[6] = vec2[6](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(0, 1), vec2(1, 0), vec2(1, 1));
  slice = gl_InstanceID;
  int axis = int(slices[slice].axis);
  vec2 corner = kCorners[gl_VertexID];
  vec3 share = vec3(0.0);
  share[axis] = slices[slice].position;
  share[(axis + 1) % 3] = corner.x;
  share[(axis + 2) % 3] = corner.y;
  place = share * (vec3(slices[slice].grid.size_x, slices[slice].grid.size_y, slices[slice].grid.size_z) - 1.0);
  gl_Position = clip_from_view * (view_from_world * (slices[slice].world_from_place * vec4(place, 1.0)));
}
