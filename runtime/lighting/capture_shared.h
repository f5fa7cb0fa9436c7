// One text for C++ and GLSL: what the shaders of the light capture bind, and the layout (std430) of their tables.
// An atlas holds tiles: rectangles of whole texels of a cube's face, subsamples² pixels to a texel.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

namespace lambent::lighting::capture {
using uint = std::uint32_t;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

// capture.vert
LAMBENT_CONSTANT kBindVertices = 0u;  // uvec4: position as bits of floats, triangle of which it is the last corner + 1
LAMBENT_CONSTANT kBindDraws = 1u;     // DrawRecord
// capture_project.comp
LAMBENT_CONSTANT kBindPoints = 0u;    // PointRecord
LAMBENT_CONSTANT kBindTexels = 1u;    // uvec2: pixel x | y << 16 of its first subsample; texel of the cube
LAMBENT_CONSTANT kBindWeights = 2u;   // float: [texel][coefficient], sh::cubeWeights
LAMBENT_CONSTANT kBindSky = 3u;       // vec4 per texel, box-filtered
LAMBENT_CONSTANT kBindRadiance = 4u;  // vec4 per triangle
LAMBENT_CONSTANT kBindLookups = 5u;   // uvec2: pixel x | y << 16, or kNoPixel; bits of the depth of the light
LAMBENT_CONSTANT kBindResults = 6u;   // vec4, see capture_project.comp
LAMBENT_CONSTANT kBindHidden = 7u;    // uint: a bit per lookup
LAMBENT_CONSTANT kUnitIds = 0u;
LAMBENT_CONSTANT kUnitDepth = 1u;

LAMBENT_CONSTANT kWorkGroupSize = 64u;
LAMBENT_CONSTANT kVertexBits = 10u;  // an index is a draw << kVertexBits | a vertex of the level
// What a pixel holds: 0 where the sky is seen, else triangle + 1, or kBlackId for the dark side of a triangle.
LAMBENT_CONSTANT kBlackId = 0x80000000u;
LAMBENT_CONSTANT kNoPixel = 0xffffffffu;
LAMBENT_CONSTANT kLookupsPerWord = 32u;

#ifndef __cplusplus
#define LAMBENT_VEC4(name) vec4 name
#else
#define LAMBENT_VEC4(name) float name[4]
#endif

// One body in one tile. Face coordinates: a direction (sc, tc, 1) w of sh::cubeFaceDirection has x = sc w, y = tc w.
struct DrawRecord {
  LAMBENT_VEC4(face_x);  // rows: face coordinates from the proxy's frame, the point at the origin
  LAMBENT_VEC4(face_y);
  LAMBENT_VEC4(face_w);
  LAMBENT_VEC4(place);   // clip x = x place.x + w place.y, clip y = y place.z + w place.w
  LAMBENT_VEC4(window);  // the tile's least and greatest sc, least and greatest tc
  uint first_vertex;
  float near_m;
  uint pad[2];
};

// A point from which some body is seen; its results follow each other in this order.
struct PointRecord {
  uint first_texel;
  uint texel_count;
  uint first_word;  // of its lookups, kLookupsPerWord to a word
  uint word_count;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
#undef LAMBENT_VEC4
static_assert(sizeof(DrawRecord) == 96 && offsetof(DrawRecord, first_vertex) == 80);
static_assert(sizeof(PointRecord) == 16);
}  // namespace lambent::lighting::capture
#endif
