// One text for C++ and GLSL: slices through grids of neighborhoods, overlay_slice.vert and .frag. C++ includes
// runtime/effects/neighborhood/neighborhood_shared.h before it.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace lambent::frame {
using glm::mat4;
using glm::vec4;
using uint = std::uint32_t;
using effects::neighborhood::GridPlace;
#define LAMBENT_CONSTANT inline constexpr
#else
#include "neighborhood_shared.h"
#undef LAMBENT_CONSTANT
#define LAMBENT_CONSTANT const
#endif

LAMBENT_CONSTANT uint kBindSlices = 1u;       // SliceRecord
LAMBENT_CONSTANT uint kBindSliceLights = 2u;  // vec4 per coefficient (GroupLights)
LAMBENT_CONSTANT float kSliceRange = 0.5f;    // of the open light, where the colours end

struct SliceRecord {
  mat4 world_from_place;  // of points of the grid
  vec4 normal;            // frame of the body; 0: of no normal
  GridPlace grid;
  uint axis;
  float position;
  uint light;         // vec4 index of the light without the body, in its frame
  uint coefficients;  // of it
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(SliceRecord) == 128 && offsetof(SliceRecord, axis) == 112);
}  // namespace lambent::frame
#endif
