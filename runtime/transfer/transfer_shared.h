// This file is shared by C++ and GLSL. It says what the kernels that evaluate coded transfer bind, and lays
// out the tables that they read (std430). Addresses within an arena page are in 32-bit words; samples and
// lights are counted in vec4s.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/transfer/codebook.hpp"

namespace lambent::transfer {
using uint = std::uint32_t;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
// The number of outputs of samples and draws with normal maps: light of bands 0..2 (codebook.hpp).
LAMBENT_CONSTANT kMappedOutputs = 9u;
LAMBENT_CONSTANT kLightsPerSample = 4u;  // light probes that may light one sample (codebook.hpp)
#endif

LAMBENT_CONSTANT kBindWork = 0u;  // WorkItem per work group
LAMBENT_CONSTANT kBindLights =
    1u;  // vec4 per coefficient: per group kLightStride for each light probe, then three times its own lights
LAMBENT_CONSTANT kBindTransfers = 2u;  // TransferRecord
LAMBENT_CONSTANT kBindFills = 2u;      // FillRecord
LAMBENT_CONSTANT kBindPlaces = 3u;     // words of a transfer's planes, and its lights
LAMBENT_CONSTANT kBindProducts =
    4u;  // vec4: a vector times the light, scaled to be multiplied by the code itself
LAMBENT_CONSTANT kBindTransfer = 5u;  // arena page: codebooks (float), positions and codes
LAMBENT_CONSTANT kBindSamples = 6u;   // arena page: vec4 per sample and output; w: see below
LAMBENT_CONSTANT kBindGaunt = 7u;  // product of spherical harmonics: offsets of its outputs, then its terms

LAMBENT_CONSTANT kWorkGroupSize = 64u;
LAMBENT_CONSTANT kLanesPerUnit = 16u;  // in the project stage, where a unit is one output of one cluster
LAMBENT_CONSTANT kUnitsPerGroup = kWorkGroupSize / kLanesPerUnit;
LAMBENT_CONSTANT kMaxWorkGroupsX = 65535u;  // promised by OpenGL 4.5; longer lists fold into y
LAMBENT_CONSTANT kKeyBlock = 64u;  // 8 bands of a light probe without key lights, then 8 of key lights alone
LAMBENT_CONSTANT kLightStride =
    2u * kKeyBlock;  // vec4s per light probe; the group's own light columns follow the last probe
LAMBENT_CONSTANT kCodes16Bit = 0x80000000u;  // 16-bit codes, else 8-bit
// A term of the table of products takes two words: j | k << 16, and its value (sh::GauntTerm).
LAMBENT_CONSTANT kGauntTermWords = 2u;

#ifndef __cplusplus
// Names the work of one work group: elements first..first + kWorkGroupSize - 1 of a cell or a draw
// (gpu::WorkItem).
struct WorkItem {
  uint record;
  uint first;
};
#endif

// In a shaded sample of a vector, w is 1 plus the luminance that arrives straight from lights that are shaded
// per pixel: from key lights by harmonics, and from the group's own lights by their columns (in the first
// output at least 0). A sample that was not shaded yet has w = 0. Surfaces take that light per pixel, by
// shadow maps and cubes; capture proxies have no pixels and send it on from here.

// Describes the resident part of one transfer of a cell, and the block of it that counts. Words are those of
// the transfer page:
//   clusters   per cluster two uints: its first vector, its number of axes
//   weights    per vector two floats: offset and scale of the weight (1 and 0 for a mean)
//   vectors    vector_size floats each: per cluster the mean, then its axes; [channel][output][column]
//   positions  per position, in the order of the codes: sample of the cell | cluster << 16
// Places hold, for each plane, the word of its codes in the page, with kCodes16Bit; and for each light, the
// vec4 index of the coefficient that belongs to column 0. There is one light, or one per light probe of the
// cell.
struct TransferRecord {
  uint light_count;
  uint first_light;  // index into the places
  uint
      light_weights_word;  // for several lights: per sample of the cell four lights, then four weights of 255
  uint columns;            // of the environment's light, or of the group's own lights
  uint channels;           // 1 or 3, in the block that counts
  uint outputs;            // 1, kMappedOutputs, or bands squared for glossy surfaces
  uint clusters;
  uint clusters_word;
  uint weights_word;
  uint vectors_word;
  uint positions_word;
  uint vector_size;
  uint first_value;  // index of the block within a vector
  uint plane_count;  // resident planes
  uint first_plane;  // index into the places
  // Output o of vector v under light k is products[first_product + light_products k + outputs v + o]. The
  // products of the means contain all offsets of weights.
  uint first_product;
  uint light_products;
  uint first_output;  // vec4 index into the samples page of the cell's first sample
  uint sample_count;
  uint accumulate;  // 1: adds to what another transfer of the cell has written
  uint order;       // bands of the environment's light; 0: the group's own lights
  uint
      visibility;  // 1: the vectors are visibility, to be multiplied with the light (project_clusters.comp)
  // These count only if lights are shaded per pixel: key lights, or some of the group's own lights. Their
  // coefficients lie `apart` vec4s after those of the other light. `bounced` is 1 if the block that counts
  // contains bounced light, so that it takes these lights too. straight_channels is the number of channels at
  // the start of a vector that carry light without bounces, which these lights do not take here.
  uint bounced;
  uint straight_channels;
  uint apart;
  uint pad;
};

// Describes a cell whose samples show the light itself, because it has no transfer or because the mode asks
// for it. A cell of a neighborhood then holds no change.
struct FillRecord {
  uint first_output;  // vec4 index into the samples page
  uint output_count;  // all samples of the cell
  uint outputs;       // per sample
  uint light;         // vec4 index of the light's first coefficient
  uint coefficients;  // of the light; 0 for a neighborhood
  uint open;          // 1: visible in all directions; 0 for a neighborhood, which holds the change V - 1
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(TransferRecord) == 104 && offsetof(TransferRecord, first_product) == 60 &&
              offsetof(TransferRecord, accumulate) == 76 && sizeof(FillRecord) == 24);
}  // namespace lambent::transfer
#endif
