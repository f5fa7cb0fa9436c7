// Computes numbers of the transfer for views of it, straight from the codes, with one invocation per position of a cell.
// For matrices (normal maps, glossy surfaces) a number is the mean over all directions of the normal, so that
// unoccluded surfaces of every kind have the same numbers. Only light from the environment counts. LAMBENT_VALUE
// selects the number: 0 the cell's constant, 1 DC; the cluster is always written.
#include "transfer_shared.h"
#include "transfer_values_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindValueCells) readonly buffer Cells { ValueCell cells[]; };
layout(std430, binding = kBindTransfers) readonly buffer Transfers { TransferRecord transfers[]; };
layout(std430, binding = kBindPlaces) readonly buffer Places { uint places[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { uint page[]; };
layout(std430, binding = kBindValues) buffer Values { SampleValue values[]; };

#include "coded_transfer.glsl"

uint codeWordAt(uint word) { return page[word]; }
float floatAt(uint word) { return uintBitsToFloat(page[word]); }

const float kY00 = 0.28209479177387814;

// Decodes one value of the vector at a position.
float decoded(TransferRecord transfer, CodedSample at, uint position, uint value) {
  uint word = transfer.vectors_word + transfer.vector_size * at.first + value;
  uint weights = transfer.weights_word + 2u * at.first;
  float sum = floatAt(word);
  for (uint axis = 0u; axis < at.axes; ++axis) {
    word += transfer.vector_size;
    weights += 2u;
    float code = float(codeOf(places[transfer.first_plane + axis], position));
    sum += (floatAt(weights) + floatAt(weights + 1u) * code) * floatAt(word);
  }
  return sum;
}

// Returns E/pi under the light whose only coefficient is l_00 = 1, averaged over channels. For a matrix it is also
// averaged over all normals.
float dcOf(TransferRecord transfer, CodedSample at, uint position) {
  if (transfer.visibility != 0u) return kY00 * kY00 * decoded(transfer, at, position, 0u);
  float sum = 0.0;
  for (uint c = 0u; c < transfer.channels; ++c)
    sum += decoded(transfer, at, position, transfer.first_value + c * transfer.outputs * transfer.columns);
  return (transfer.outputs > 1u ? kY00 : 1.0) * sum / float(transfer.channels);
}

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  ValueCell cell = cells[work[index].record];
  TransferRecord transfer = transfers[cell.transfer];
  uint position = work[index].first + gl_LocalInvocationID.x;
  if (position >= transfer.sample_count) return;
  CodedSample at = codedSampleAt(transfer, position);
#if LAMBENT_VALUE == 0
  float value = cell.constant;
#else
  float value = dcOf(transfer, at, position);
#endif
  uint out_index = cell.first_value + at.sample_index;
  if (transfer.accumulate != 0u) {
    // This is the bounced light of a glossy surface, which has a transfer of its own. Its DC adds to that of the
    // first transfer, which also wrote the cluster.
    values[out_index].value_bits = floatBitsToUint(uintBitsToFloat(values[out_index].value_bits) + value);
    return;
  }
  values[out_index] = SampleValue(floatBitsToUint(value), cell.cell << 16u | (page[transfer.positions_word + position] >> 16u));
}
