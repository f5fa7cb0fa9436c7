// One text for C++ and GLSL: how light that lamps' rooms send on is gathered at vertices (patch_gather.comp).
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/mat3x4.hpp>

namespace lambent::frame {
using uint = std::uint32_t;
using glm::mat3x4;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindPatchDraw = 0u;        // uniform block PatchDraw
LAMBENT_CONSTANT kBindPatchLinks = 0u;       // kPatchLinks patches of 16 bits to a vertex
LAMBENT_CONSTANT kBindPatches = 1u;     // vec4: what a patch gives off; of each group one more that is dark
LAMBENT_CONSTANT kBindPatchBounced = 2u;     // what arrives: 3 floats a vertex, E/pi, or light of bands 0..2, 27
LAMBENT_CONSTANT kBindPatchGeometry = 3u;    // arena page
LAMBENT_CONSTANT kBindPatchDirections = 4u;  // vec4: of the links, in the vertex's frame

LAMBENT_CONSTANT kPatchGroupSize = 64u;
LAMBENT_CONSTANT kPatchLinks = 64u;  // lighting::kLinks

struct PatchDraw {
  mat3x4 group_from_mesh_normal;
  uint first_patch;  // of the group
  uint vertex_count;
  uint bounced_word;
  uint normals_word;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(PatchDraw) == 64);
}  // namespace lambent::frame
#endif
