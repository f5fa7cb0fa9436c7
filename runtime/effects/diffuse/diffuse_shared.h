// This file is shared by C++ and GLSL. It says what the diffuse kernels bind besides transfer_shared.h, and lays out
// the tables that they read (std430). Addresses within an arena page are in 32-bit words; samples and lights are
// counted in vec4s.
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
LAMBENT_CONSTANT kBindGeometry = 4u;   // arena page, holds the normals
LAMBENT_CONSTANT kBindRadiance = 5u;   // arena page: per vertex 4 floats, E/pi and the luminance of lights
                                       // per pixel in it, or for normal maps 27, [output][rgb]
LAMBENT_CONSTANT kBindProxyGroups = 2u;     // ProxyGroupRecord
LAMBENT_CONSTANT kBindProxyTriangles = 3u;  // ProxyTriangleRecord
LAMBENT_CONSTANT kBindProxyEntries = 4u;    // ProxyEntryRecord
LAMBENT_CONSTANT kBindProxyRadiance = 5u;   // vec4 per triangle
LAMBENT_CONSTANT kBindProxyAdded = 7u;      // vec4 per triangle, radiance to send out in addition

LAMBENT_CONSTANT kTexelGroupSize = 8u;  // side of a work group over texels

LAMBENT_CONSTANT kNoRows = 0xffffffffu;
LAMBENT_CONSTANT kNoLamp = 0xffffffffu;

struct DrawRecord {
  float group_from_mesh_normal[12];  // three columns of vec4, which turn normals
  uint light;
  uint order;
  uint vertex_count;
  uint normals_word;
  uint rows_word;  // vertex_count + 1 offsets, then samples, then weights two to a word; kNoRows: unshadowed
  uint row_entries;
  uint first_sample;   // of the draw; output o of sample s is vec4 first_output + outputs (s - first_sample) + o
  uint radiance_word;  // where the result is written
  uint outputs;
  uint first_output;
  uint texels;       // side of its texture; 0: none to be shaded
  uint texels_word;  // the sample of each texel, row by row; kNoRows: unshadowed, as the vertices show
};

// A capture proxy's triangles each send out one radiance in all directions (runtime/bundle/capture_proxy.hpp).
struct ProxyGroupRecord {
  uint first_triangle;
  uint triangle_count;
  uint light;  // vec4 index of the coefficients of its first light probe
  uint lamps;  // vec4 index of its own lights; those that are shaded per pixel follow after 2 lamp_count
  uint order;
  uint lamp_count;
  uint pad[2];
};

struct ProxyTriangleRecord {
  float normal[3];  // group frame
  uint first_entry;
  float emission[3];  // at unit strength of its lamp
  uint entry_count;
  uint lamp;  // index of the lamp in its group; kNoLamp: the triangle emits nothing
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
