// Writes the shaded samples of grid points into the atlas, with one invocation per output of a point.
#include "neighborhood_shared.h"

struct WorkItem {
  uint record;
  uint first;
};

layout(local_size_x = kWriteGroupSize) in;
layout(std430, binding = kBindWriteWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindWrites) readonly buffer Writes { WriteRecord writes[]; };
layout(std430, binding = kBindWriteSamples) readonly buffer Samples { vec4 samples[]; };
layout(rgba16f, binding = kImageAtlas) writeonly uniform image3D atlas;

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kWriteGroupsX;
  if (index >= work_count) return;
  WriteRecord cell = writes[work[index].record];
  uint element = work[index].first + gl_LocalInvocationID.x;
  if (element >= cell.point_count * cell.grid.outputs) return;
  // Neighbouring invocations write points that are neighbours in the texture.
  uint point = cell.first_point + element % cell.point_count, slab = element / cell.point_count;
  vec4 change = samples[cell.first_output + cell.grid.outputs * (point - cell.first_point) + slab];
  uint x = point % cell.grid.size_x, row = point / cell.grid.size_x;
  uint y = row % cell.grid.size_y, z = row / cell.grid.size_y;
  uvec3 texel = uvec3(x, cell.grid.first_y + cell.grid.size_y * (slab / cell.grid.slabs_per_column) + y,
                      cell.grid.first_z + cell.grid.size_z * (slab % cell.grid.slabs_per_column) + z);
  // The largest half float is 65504. Visibility needs no scale.
  imageStore(atlas, ivec3(texel), vec4(clamp(change.rgb / cell.grid.scale, -6e4, 6e4), change.a));
}
