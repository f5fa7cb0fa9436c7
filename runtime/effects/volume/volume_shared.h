// One text for C++ and GLSL: what the kernels of volumes bind, and the layout (std430) of the tables that they read.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace lambent::effects::volume {
using uint = std::uint32_t;
using glm::uvec3, glm::vec3, glm::vec4;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

// Scatter: samples to textures.
LAMBENT_CONSTANT kBindWork = 0u;     // WorkItem per work group
LAMBENT_CONSTANT kBindLights = 1u;   // as diffuse_shared.h has it
LAMBENT_CONSTANT kBindScatter = 2u;  // ScatterRecord
LAMBENT_CONSTANT kBindVoxels = 3u;   // of a volume: per sample its voxel
LAMBENT_CONSTANT kBindSamples = 4u;  // arena page
LAMBENT_CONSTANT kImageLight = 0u;   // of a volume: the texture that is written
// March.
LAMBENT_CONSTANT kBindMarch = 0u;   // MarchRecord
LAMBENT_CONSTANT kBindBlocks = 1u;  // of all volumes: largest density per block, 0 where it is empty
LAMBENT_CONSTANT kUnitDepth = 0u;   // the picture's depth; of the other pass what was marched
LAMBENT_CONSTANT kUnitMarched = 1u;
// Density and light of volume v: no more than the sixteen units that OpenGL 4.5 promises a stage, with depth in one.
LAMBENT_CONSTANT kUnitDensity = 1u;

LAMBENT_CONSTANT kMaxMarched = 7u;  // volumes in one pass
LAMBENT_CONSTANT kScatterGroupSize = 64u;
LAMBENT_CONSTANT kMaxWorkGroupsX = 65535u;  // what OpenGL 4.5 promises; longer lists fold into y
LAMBENT_CONSTANT kBlock = 8u;               // voxels of the density along a block
LAMBENT_CONSTANT kMaxLightSide = 2048u;     // texels of a texture: what OpenGL 4.5 promises

#ifndef __cplusplus
struct WorkItem {
  uint record;
  uint first;
};
#endif

// A cell of a volume. Output j of a voxel goes to its texel in slab j of the texture; slabs stand one behind the other
// along z, `slabs_z` of them, then side by side along x.
struct ScatterRecord {
  uint first_output;  // vec4 index into the samples page of the cell's first sample
  uint first_voxel;   // of the cell's first sample, in the list
  uint sample_count;
  uint outputs;  // 1: mean radiance; bands squared: the radiance that arrives, in spherical harmonics
  uint size[3];  // voxels of the transfer grid
  uint slabs_z;
  uint open;   // coefficients of the light that is shown itself, for want of transfer; 0: the samples are shown
  uint light;  // vec4 index of its first coefficient
  float g;
  uint pad;
};

// A volume as rays meet it. Matrices are three rows of an affine map.
struct MarchRecord {
  vec4 box_from_view[3];    // the volume is the box from 0 to 1
  vec4 group_from_view[3];  // turns directions; lengths go over into metres of the group
  vec3 albedo;
  float density_scale;  // m^-1 of the group's metre, of density 1
  uvec3 size;           // voxels of the density
  uint first_block;
  uvec3 transfer_size;
  uint outputs;
  uvec3 light_size;  // of the texture with all slabs
  uint slabs_z;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ScatterRecord) == 48 && offsetof(ScatterRecord, g) == 40);
static_assert(sizeof(MarchRecord) == 160 && offsetof(MarchRecord, albedo) == 96 && offsetof(MarchRecord, size) == 112);
}  // namespace lambent::effects::volume
#endif
