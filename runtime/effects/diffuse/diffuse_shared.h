// One text for C++ and GLSL: what the diffuse kernels bind, and the layout (std430) of the tables that they read.
// Addresses within an arena page are in 32-bit words; samples and lights are counted in vec4s.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

namespace lambent::effects::diffuse {
using uint = std::uint32_t;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindWork = 0u;      // WorkItem per work group
LAMBENT_CONSTANT kBindLights = 1u;    // vec4 per coefficient, a block per group of kLightStride and more
LAMBENT_CONSTANT kBindCells = 2u;     // CellRecord
LAMBENT_CONSTANT kBindVectors = 3u;   // VectorRecord
LAMBENT_CONSTANT kBindProducts = 4u;  // Product
LAMBENT_CONSTANT kBindTransfer = 5u;  // arena page: basis vectors (float) and codes
LAMBENT_CONSTANT kBindSamples = 6u;   // arena page: vec4 per sample, w = 1 where it has been shaded
LAMBENT_CONSTANT kBindDraws = 2u;     // DrawRecord
LAMBENT_CONSTANT kBindRows = 3u;      // arena page: rows of vertices
LAMBENT_CONSTANT kBindGeometry = 4u;  // arena page: normals among others
LAMBENT_CONSTANT kBindRadiance = 5u;  // arena page: 3 floats per vertex, E/pi

LAMBENT_CONSTANT kWorkGroupSize = 64u;
LAMBENT_CONSTANT kMaxWorkGroupsX = 65535u;  // what OpenGL 4.5 promises; longer lists fold into y
LAMBENT_CONSTANT kLightStride = 64u;        // 8 bands; the group's own light columns follow
LAMBENT_CONSTANT kCodes16Bit = 0x80000000u;  // in Product::codes: 16-bit codes, else 8-bit
LAMBENT_CONSTANT kNoRows = 0xffffffffu;

#ifndef __cplusplus
// What one work group does: elements first..first + kWorkGroupSize - 1 of a cell or a draw (gpu::WorkItem).
struct WorkItem {
  uint record;
  uint first;
};
#endif

// A cell whose transfer is resident, wholly or in part.
struct CellRecord {
  uint light;          // vec4 index of the group's light
  uint first_vector;   // into the VectorRecords
  uint vector_count;   // means and planes that are resident
  uint first_product;  // products[first_product] is the mean, with all offsets in it; planes follow
  uint plane_count;    // resident planes of all parts
  uint first_output;   // vec4 index into the samples page
  uint sample_count;
  uint order;
};

// A mean (slot 0, weight 1) or a basis vector (slot j >= 1, weight offset + scale * code).
struct VectorRecord {
  uint basis_word;  // channels x columns floats, channel-major
  uint codes;       // word of the plane's codes, with kCodes16Bit
  float offset;
  float scale;
  uint channels;  // 1 or 3
  uint columns;   // order² + light columns
  uint order;
  uint slot;
};

// A vector times the light, scaled to be multiplied by the code itself.
struct Product {
  float r, g, b;
  uint codes;
};

struct DrawRecord {
  float group_from_mesh_normal[12];  // three columns of vec4, for directions of normals
  uint light;
  uint order;
  uint vertex_count;
  uint normals_word;
  uint rows_word;  // vertex_count + 1 offsets, then samples, then weights two to a word; kNoRows: unshadowed
  uint row_entries;
  uint first_sample;   // vec4 index of the group's first sample
  uint radiance_word;  // where the result goes
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(CellRecord) == 32 && offsetof(CellRecord, first_product) == 12 && offsetof(CellRecord, order) == 28);
static_assert(sizeof(VectorRecord) == 32 && offsetof(VectorRecord, offset) == 8 && offsetof(VectorRecord, slot) == 28);
static_assert(sizeof(Product) == 16);
static_assert(sizeof(DrawRecord) == 80 && offsetof(DrawRecord, light) == 48 && offsetof(DrawRecord, rows_word) == 64);
}  // namespace lambent::effects::diffuse
#endif
