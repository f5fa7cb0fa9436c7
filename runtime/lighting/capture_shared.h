// This file is shared by C++ and GLSL. It holds the binding points of the light capture's shaders and the
// layout (std430) of their tables. An atlas holds tiles, which are rectangles of whole texels of a cube's
// face with subsamples² pixels per texel.
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

// Tables that lanes read at distant places are buffer textures, because software renderers fetch whole
// vectors from these but single values from storage blocks.
//
// These are bindings of capture.vert.
LAMBENT_CONSTANT kUnitVertices = 0u;  // rgba32ui: bits of the position; id of the triangle that ends here
LAMBENT_CONSTANT kUnitDraws = 1u;     // rgba32ui: DrawRecord, kDrawTexels texels each
// These are bindings of capture_resolve.comp.
LAMBENT_CONSTANT kUnitIds = 0u;  // the atlas of ids
LAMBENT_CONSTANT kUnitDepth = 1u;
LAMBENT_CONSTANT kBindTexels = 0u;    // TexelRecord
LAMBENT_CONSTANT kBindRadiance = 1u;  // vec4 per triangle
LAMBENT_CONSTANT kBindValues = 2u;    // vec4 per TexelRecord: mean radiance of bodies, share that they hide
LAMBENT_CONSTANT kBindLookups = 3u;   // uvec2: pixel x | y << 16, or kNoPixel; bits of the light's depth
LAMBENT_CONSTANT kBindHidden = 4u;    // uint per kLookupsPerWord lookups, one bit each
// These are bindings of capture_project.comp.
LAMBENT_CONSTANT kUnitValues = 0u;   // rgba32f
LAMBENT_CONSTANT kUnitTexels = 1u;   // rg32ui: TexelRecord
LAMBENT_CONSTANT kUnitSky = 2u;      // rgba32f per texel of the cube, box-filtered
LAMBENT_CONSTANT kUnitWeights = 3u;  // rgba32f: [texel][coefficient], padded to fours, sh::cubeWeights
LAMBENT_CONSTANT kBindPoints = 0u;   // PointRecord
LAMBENT_CONSTANT kBindResults = 1u;  // vec4, see capture_project.comp

// These are bindings of capture_sky.comp.
LAMBENT_CONSTANT kUnitFirstProbes = 0u;
LAMBENT_CONSTANT kUnitSecondProbes = 1u;
LAMBENT_CONSTANT kBindSky = 0u;
LAMBENT_CONSTANT kBindSkyLight = 3u;  // vec4 per coefficient

LAMBENT_CONSTANT kWorkGroupSize = 64u;
LAMBENT_CONSTANT kVertexBits = 11u;  // an index is draw << kVertexBits | vertex of the level
// A pixel holds 0 where the sky is visible, a triangle's number + 1, or kBlackId for the dark side of a
// triangle.
LAMBENT_CONSTANT kBlackId = 0x80000000u;
LAMBENT_CONSTANT kNoPixel = 0xffffffffu;
LAMBENT_CONSTANT kLookupsPerWord = 32u;

LAMBENT_CONSTANT kDrawTexels = 4u;

// Describes one body in one tile. Clip coordinates are divided by the near plane's distance, so that z is 1
// and w is the distance along the face's axis in multiples of the near plane's distance.
struct DrawRecord {
  float clip_x[4];  // rows: clip coordinates from the proxy's frame, shifted to the tile's place in the atlas
  float clip_y[4];
  float clip_w[4];
  uint first_vertex;
  uint tile_x;  // range of pixels in the atlas: first | end << 16
  uint tile_y;
  uint pad;
};

// Describes a texel of a point's cube that a tile covers.
struct TexelRecord {
  uint pixel;  // x | y << 16 of its first subsample in the atlas
  uint texel;  // index of the texel in the cube
};

// Describes a point from which a body is visible. Results are stored in the order of these records.
struct PointRecord {
  uint first_texel;
  uint texel_count;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(DrawRecord) == 16 * kDrawTexels && offsetof(DrawRecord, first_vertex) == 48);
static_assert(sizeof(TexelRecord) == 8 && sizeof(PointRecord) == 8);
}  // namespace lambent::lighting::capture
#endif
