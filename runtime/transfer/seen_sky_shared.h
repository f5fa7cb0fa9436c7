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

// The kernels of evaluate/seen_sky.hpp bind and read these besides transfer_shared.h.
LAMBENT_CONSTANT kBindSeenCells = 1u;     // SeenCell
LAMBENT_CONSTANT kBindSeenSamples = 6u;   // per sample and output kSeenWords words
LAMBENT_CONSTANT kBindSeenDraws = 1u;     // SeenDraw
LAMBENT_CONSTANT kBindSeenRows = 2u;      // arena page
LAMBENT_CONSTANT kBindSeenGeometry = 3u;  // arena page, holds the normals
LAMBENT_CONSTANT kBindSeenVertices = 4u;  // arena page of radiance

struct SeenCell {
  uint transfer;    // index of the TransferRecord
  uint first_word;  // of the cell's first sample
};

struct SeenDraw {
  float group_from_mesh_normal[12];  // three columns of vec4
  uint vertex_count;
  uint normals_word;
  uint rows_word;
  uint row_entries;
  uint first_sample;  // the sample of the group whose words are at samples_word
  uint samples_word;
  uint seen_word;  // where the result is written
  uint pad;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(SeenDraw) == 80);
}  // namespace lambent::transfer
#endif
