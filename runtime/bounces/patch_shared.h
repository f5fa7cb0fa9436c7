// This file is shared by C++ and GLSL. It holds the bindings of patch_gather.comp, which gathers the light of
// patches at vertices.
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
LAMBENT_CONSTANT kBindPatchLinks = 0u;       // kPatchLinks patches of 16 bits per vertex
LAMBENT_CONSTANT kBindPatches = 1u;          // vec4 per patch: exit radiance, and the luminance of that by the bands of all light; each group has one more, dark
LAMBENT_CONSTANT kBindPatchBounced = 2u;     // per vertex 3 floats, E/pi, or 27, light of bands 0..2; then the luminance of the first by the bands of all light
LAMBENT_CONSTANT kBindPatchGeometry = 3u;    // arena page
LAMBENT_CONSTANT kBindPatchDirections = 4u;  // vec4: directions of the links, in the vertex's frame

LAMBENT_CONSTANT kPatchGroupSize = 64u;
LAMBENT_CONSTANT kPatchLinks = 64u;  // the same as lighting::kLinks

struct PatchDraw {
  mat3x4 group_from_mesh_normal;
  uint first_patch;  // first patch of the group
  uint vertex_count;
  uint bounced_word;
  uint normals_word;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(PatchDraw) == 64);
}  // namespace lambent::frame
#endif
