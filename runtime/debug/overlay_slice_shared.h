// This file is shared by C++ and GLSL. It describes slices through grids of neighborhoods, for
// overlay_slice.glsl. C++ includes runtime/effects/neighborhood/neighborhood_shared.h before it.
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

LAMBENT_CONSTANT uint kBindSlices = 1u;       // array of SliceRecord
LAMBENT_CONSTANT uint kBindSliceLights = 2u;  // vec4 per coefficient (GroupLights)
LAMBENT_CONSTANT float kSliceRange = 0.5f;    // change, relative to the unoccluded light, where colours end

struct SliceRecord {
  mat4 world_from_place;  // from coordinates of the grid
  vec4 normal;            // in the body's frame; 0: show the mean radiance
  GridPlace grid;
  uint axis;
  float position;
  uint light;         // vec4 index of the light without the body, in its frame
  uint coefficients;  // number of its coefficients
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(SliceRecord) == 128 && offsetof(SliceRecord, axis) == 112);
}  // namespace lambent::frame
#endif
