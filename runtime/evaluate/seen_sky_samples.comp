// Decodes what samples see of the sky, with one invocation per position of a cell. LAMBENT_OUTPUTS is 1, or 9 for
// normal-mapped samples, whose outputs become one at the normal of a vertex (seen_sky_vertices.comp).
#include "transfer_shared.h"
#include "seen_sky_kernels.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindSeenCells) readonly buffer Cells { SeenCell cells[]; };
layout(std430, binding = kBindTransfers) readonly buffer Transfers { TransferRecord transfers[]; };
layout(std430, binding = kBindPlaces) readonly buffer Places { uint places[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { uint page[]; };
layout(std430, binding = kBindSeenSamples) writeonly buffer Seen { uint seen[]; };

#include "coded_transfer.glsl"

uint codeWordAt(uint word) { return page[word]; }
float floatAt(uint word) { return uintBitsToFloat(page[word]); }

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  SeenCell cell = cells[work[index].record];
  TransferRecord transfer = transfers[cell.transfer];
  uint position = work[index].first + gl_LocalInvocationID.x;
  if (position >= transfer.sample_count) return;
  CodedSample at = codedSampleAt(transfer, position);
  uint known = min(transfer.order * transfer.order, kSeenCoefficients);
  float share = 1.0 / float(transfer.channels);
  uint out_word = cell.first_word + kSeenWords * LAMBENT_OUTPUTS * at.sample_index;
  for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) {
    float sums[2u * kSeenWords];
    for (uint k = 0u; k < 2u * kSeenWords; ++k) sums[k] = 0.0;
    for (uint c = 0u; c < transfer.channels; ++c) {
      uint word = transfer.vectors_word + transfer.vector_size * at.first + transfer.first_value +
                  (c * transfer.outputs + j) * transfer.columns;
      for (uint k = 0u; k < known; ++k) sums[k] += share * floatAt(word + k);
      for (uint axis = 0u; axis < at.axes; ++axis) {
        word += transfer.vector_size;
        uint weights = transfer.weights_word + 2u * (at.first + axis + 1u);
        float code = float(codeOf(places[transfer.first_plane + axis], position));
        float weight = share * (floatAt(weights) + floatAt(weights + 1u) * code);
        for (uint k = 0u; k < known; ++k) sums[k] += weight * floatAt(word + k);
      }
    }
    sums[2u * kSeenWords - 1u] = 1.0;
    for (uint i = 0u; i < kSeenWords; ++i)
      seen[out_word + kSeenWords * j + i] = packHalf2x16(vec2(sums[2u * i], sums[2u * i + 1u]));
  }
}
