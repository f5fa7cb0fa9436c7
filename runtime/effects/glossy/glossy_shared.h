// This file is shared by C++ and GLSL. It says what the kernels of the glossy effect bind and read besides
// transfer_shared.h.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

namespace lambent::effects::glossy {
using uint = std::uint32_t;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#include "transfer_shared.h"
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindFills = 2u;  // FillRecord

// Describes a cell whose samples show the light itself, because it has no transfer or because the mode asks for it. A
// cell of a neighborhood then holds no change.
struct FillRecord {
  uint first_output;   // vec4 index into the samples page
  uint output_count;   // all samples of the cell
  uint outputs;        // per sample
  uint light;          // vec4 index of the light's first coefficient
  uint coefficients;   // of the light; 0 for a neighborhood
  uint open;           // 1: visible in all directions; 0 for a neighborhood, which holds the change V - 1
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(FillRecord) == 24);
}  // namespace lambent::effects::glossy
#endif
