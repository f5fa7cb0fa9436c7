// One text for C++ and GLSL: what transfer_values.comp binds besides diffuse_shared.h, and what it leaves for views.
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
LAMBENT_CONSTANT kBindProducts3 = 7u;   // of the product of spherical harmonics: offsets of nine outputs, then the terms
LAMBENT_CONSTANT kNoCluster = 0xffffffffu;

// A transfer of a cell.
struct ValueCell {
  uint transfer;     // TransferRecord
  uint first_value;  // of its first sample
  uint cell;         // of the residency
  float constant;    // what its samples have where they all have the same
};

// Of a sample of a surface, group by group in the order of its samples. value_bits are those of a float.
struct SampleValue {
  uint value_bits;
  uint cluster;  // cell << 16 | cluster; kNoCluster: its transfer is not here
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ValueCell) == 16 && sizeof(SampleValue) == 8);
}  // namespace lambent::evaluate
#endif
