// This file is shared by C++ and GLSL. It says what transfer_values.comp binds besides transfer_shared.h, and what it
// writes for views.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

namespace lambent::evaluate {
using uint = std::uint32_t;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindValueCells = 1u;  // ValueCell
LAMBENT_CONSTANT kBindValues = 6u;      // SampleValue
LAMBENT_CONSTANT kNoCluster = 0xffffffffu;

// Names a transfer of a cell.
struct ValueCell {
  uint transfer;     // index of the TransferRecord
  uint first_value;  // index of the first sample's value
  uint cell;         // index in the residency
  float constant;    // value of all samples, if the question asks for a number per cell
};

// Holds the value at a sample of a surface. Samples are in their order, group by group. value_bits are the bits of a
// float.
struct SampleValue {
  uint value_bits;
  uint cluster;  // cell << 16 | cluster; kNoCluster: the transfer is not resident
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ValueCell) == 16 && sizeof(SampleValue) == 8);
}  // namespace lambent::evaluate
#endif
