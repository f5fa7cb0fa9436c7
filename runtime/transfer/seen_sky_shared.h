// This file is shared by C++ and GLSL. It says how a vertex keeps what it sees of the sky: the first bands of
// transfer without bounces, t_k = (1/pi) ∫ V max(n·s, 0) y_k ds, as half floats, two to a word.
#ifdef __cplusplus
#pragma once

#include <cstdint>

namespace lambent::transfer {
using uint = std::uint32_t;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kSeenBands = 5u;
LAMBENT_CONSTANT kSeenCoefficients = kSeenBands * kSeenBands;
// The last half is 1 if the coefficients are known, in samples; vertices always know theirs.
LAMBENT_CONSTANT kSeenWords = (kSeenCoefficients + 1u) / 2u;

LAMBENT_CONSTANT kSeenWeights = kSeenBands * (kSeenBands + 1u) / 2u;  // of the kernel that reads them

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
}  // namespace lambent::transfer
#endif
