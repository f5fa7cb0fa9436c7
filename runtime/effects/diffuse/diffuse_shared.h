// One text for C++ and GLSL: what the diffuse kernels bind besides transfer_shared.h, and the layout (std430) of the tables that they read.
// Addresses within an arena page are in 32-bit words; samples and lights are counted in vec4s.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/transfer/transfer_shared.h"

namespace lambent::effects::diffuse {
using uint = std::uint32_t;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#include "transfer_shared.h"
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindDraws = 2u;      // DrawRecord
LAMBENT_CONSTANT kBindRows = 3u;       // arena page: rows of vertices
LAMBENT_CONSTANT kBindGeometry = 4u;   // arena page: normals among others
LAMBENT_CONSTANT kBindRadiance = 5u;   // arena page: per vertex 3 floats, E/pi, or for normal maps 27, [output][rgb]
LAMBENT_CONSTANT kBindProxyGroups = 2u;     // ProxyGroupRecord
LAMBENT_CONSTANT kBindProxyTriangles = 3u;  // ProxyTriangleRecord
LAMBENT_CONSTANT kBindProxyEntries = 4u;    // ProxyEntryRecord
LAMBENT_CONSTANT kBindProxyRadiance = 5u;   // vec4 per triangle
LAMBENT_CONSTANT kBindProxyAdded = 7u;      // likewise: what it sends out besides

LAMBENT_CONSTANT kNoRows = 0xffffffffu;
LAMBENT_CONSTANT kNoLamp = 0xffffffffu;

struct DrawRecord {
  float group_from_mesh_normal[12];  // three columns of vec4, for directions of normals
  uint light;
  uint order;
  uint vertex_count;
  uint normals_word;
  uint rows_word;  // vertex_count + 1 offsets, then samples, then weights two to a word; kNoRows: unshadowed
  uint row_entries;
  uint first_sample;   // of its samples; output o of sample s is vec4 first_output + outputs (s - first_sample) + o
  uint radiance_word;  // where the result goes
  uint outputs;
  uint first_output;
  uint pad[2];
};

// Capture proxies: triangles that send out one radiance in all directions (runtime/bundle/capture_proxy.hpp).
struct ProxyGroupRecord {
  uint first_triangle;
  uint triangle_count;
  uint light;  // vec4 index of the coefficients of its first light probe
  uint lamps;  // and of its own lights
  uint order;
  uint pad[3];
};

struct ProxyTriangleRecord {
  float normal[3];  // group frame
  uint first_entry;
  float emission[3];  // at unit strength of its lamp
  uint entry_count;
  uint lamp;  // of the group; kNoLamp: gives off none
  uint pad[3];
};

struct ProxyEntryRecord {
  float reflectance[3];
  uint sample_index;  // vec4 index into the samples page of its first output
  uint outputs;
  uint pad[3];
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ProxyGroupRecord) == 32 && sizeof(ProxyTriangleRecord) == 48 && sizeof(ProxyEntryRecord) == 32);
static_assert(sizeof(DrawRecord) == 96 && offsetof(DrawRecord, light) == 48 && offsetof(DrawRecord, outputs) == 80);
}  // namespace lambent::effects::diffuse
#endif
