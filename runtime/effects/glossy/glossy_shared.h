// One text for C++ and GLSL: what the kernels of the glossy effect bind and read besides transfer_shared.h.
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

// A cell that shows the light itself, for want of transfer or because it was asked for. One of a neighborhood changes
// nothing then.
struct FillRecord {
  uint first_output;   // vec4 index into the samples page
  uint output_count;   // all samples of the cell
  uint outputs;        // of a sample
  uint light;          // vec4 index of the light's first coefficient
  uint coefficients;   // of the light; 0 of a neighborhood
  uint open;           // 1: visible in all directions; 0 of a neighborhood, which holds the change V - 1
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(FillRecord) == 24);
}  // namespace lambent::effects::glossy
#endif
