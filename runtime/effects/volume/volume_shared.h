// This file is shared by C++ and GLSL. It says what the kernels of volumes bind, and lays out the tables that they
// read (std430).
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

// These are bindings of the scatter kernel, which copies samples into textures.
LAMBENT_CONSTANT kBindWork = 0u;     // WorkItem per work group
LAMBENT_CONSTANT kBindLights = 1u;   // as in transfer_shared.h
LAMBENT_CONSTANT kBindScatter = 2u;  // ScatterRecord
LAMBENT_CONSTANT kBindVoxels = 3u;   // voxel of each sample of a volume
LAMBENT_CONSTANT kBindSamples = 4u;  // arena page
LAMBENT_CONSTANT kImageLight = 0u;   // texture of a volume, written
// These are bindings of the march.
LAMBENT_CONSTANT kBindMarch = 0u;   // MarchRecord
LAMBENT_CONSTANT kBindBlocks = 1u;  // largest density per block, for all volumes; 0 where a block is empty
LAMBENT_CONSTANT kUnitDepth = 0u;   // depth of the picture; of all samples, to composite what was marched
LAMBENT_CONSTANT kUnitMarched = 1u;
// These are the first texture units of density and light, one per volume. With depth they fit the sixteen units that
// OpenGL 4.5 promises a stage.
LAMBENT_CONSTANT kUnitDensity = 1u;

LAMBENT_CONSTANT kMaxMarched = 7u;  // volumes in one pass
LAMBENT_CONSTANT kScatterGroupSize = 64u;
LAMBENT_CONSTANT kMaxWorkGroupsX = 65535u;  // promised by OpenGL 4.5; longer lists fold into y
// No ray needs more steps in a block, at the finest step: its diagonal is 14 voxels, and a step an eighth of a voxel or
// half of that. A ray that is not a number must not keep the GPU busy for ever.
LAMBENT_CONSTANT kMostSteps = 256u;
LAMBENT_CONSTANT kBlock = 8u;               // voxels of the density along one side of a block
LAMBENT_CONSTANT kMaxLightSide = 2048u;     // texels along a texture's side, promised by OpenGL 4.5

#ifndef __cplusplus
struct WorkItem {
  uint record;
  uint first;
};
#endif

// Describes a cell of a volume. Output j of a voxel goes to its texel in slab j of the texture. Slabs stand one
// behind the other along z, `slabs_z` of them, then side by side along x.
struct ScatterRecord {
  uint first_output;  // vec4 index into the samples page of the cell's first sample
  uint first_voxel;   // index of the cell's first sample in the list of voxels
  uint sample_count;
  uint outputs;  // 1: mean radiance; bands squared: the radiance that arrives, in spherical harmonics
  uint size[3];  // voxels of the transfer grid
  uint slabs_z;
  uint open;   // coefficients of the light, if it is shown itself because transfer is missing; 0: samples are shown
  uint light;  // vec4 index of the light's first coefficient
  float g;
  uint pad;
};

// Describes a volume to the march. Matrices are three rows of an affine map.
struct MarchRecord {
  vec4 box_from_view[3];    // maps the volume to the box from 0 to 1
  vec4 group_from_view[3];  // turns directions and scales metres of the view to metres of the group
  vec3 albedo;
  float density_scale;  // extinction at density 1, per metre of the group
  uvec3 size;           // voxels of the density
  uint first_block;
  uvec3 transfer_size;
  uint outputs;
  uvec3 light_size;  // size of the texture with all slabs
  uint slabs_z;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ScatterRecord) == 48 && offsetof(ScatterRecord, g) == 40);
static_assert(sizeof(MarchRecord) == 160 && offsetof(MarchRecord, albedo) == 96 && offsetof(MarchRecord, size) == 112);
}  // namespace lambent::effects::volume
#endif
