// Computes numbers of the transfer for views of it, straight from the codes, with one invocation per position of a cell.
// For matrices (normal maps, glossy surfaces) a number is the mean over all directions of the normal, so that
// unoccluded surfaces of every kind have the same numbers. Only light from the environment counts. LAMBENT_VALUE
// selects the number: 0 the cell's constant, 1 DC, 2 the energy of a band; the cluster is always written.
// LAMBENT_VISIBILITY is set if the vector is visibility, to the number of bands of the light.
#include "transfer_shared.h"
#include "transfer_values_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindValueCells) readonly buffer Cells { ValueCell cells[]; };
layout(std430, binding = kBindTransfers) readonly buffer Transfers { TransferRecord transfers[]; };
layout(std430, binding = kBindPlaces) readonly buffer Places { uint places[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { uint page[]; };
layout(std430, binding = kBindValues) buffer Values { SampleValue values[]; };
#ifdef LAMBENT_VISIBILITY
layout(std430, binding = kBindProducts3) readonly buffer Products { uint gaunt[]; };
#endif
layout(location = 0) uniform uint band;

#include "coded_transfer.glsl"

uint codeWordAt(uint word) { return page[word]; }
float floatAt(uint word) { return uintBitsToFloat(page[word]); }

const float kY00 = 0.28209479177387814;
const float kFourPi = 12.566370614359172;

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

// Returns A_l/pi for one of the nine outputs that a diffuse receiver takes.
float cosineOverPi(uint j) { return j == 0u ? 1.0 : j < 4u ? 2.0 / 3.0 : 0.25; }

#ifdef LAMBENT_VISIBILITY
const uint kLeast = uint((LAMBENT_VISIBILITY + 2) * (LAMBENT_VISIBILITY + 2));
float energyOf(TransferRecord transfer, CodedSample at, uint position) {
  if (band >= uint(LAMBENT_VISIBILITY)) return 0.0;
  float visibility[kLeast];
  for (uint k = 0u; k < kLeast; ++k) visibility[k] = decoded(transfer, at, position, k);
  uint first = band * band, count = 2u * band + 1u;
  float energy = 0.0;
  for (uint j = 0u; j < kMappedOutputs; ++j) {
    float row[15];
    for (uint m = 0u; m < 15u; ++m) row[m] = 0.0;
    for (uint t = gaunt[j]; t < gaunt[j + 1u]; ++t) {
      uint jk = gaunt[kMappedOutputs + 1u + 2u * t];
      uint m = (jk & 0xffffu) - first;
      if (m < count) row[m] += uintBitsToFloat(gaunt[kMappedOutputs + 2u + 2u * t]) * visibility[jk >> 16u];
    }
    float weight = cosineOverPi(j);
    for (uint m = 0u; m < count; ++m) energy += weight * row[m] * weight * row[m];
  }
  return energy / kFourPi;
}
#else
float energyOf(TransferRecord transfer, CodedSample at, uint position) {
  if (band >= transfer.order) return 0.0;
  uint first = band * band, count = 2u * band + 1u;
  uint rows = transfer.outputs == 1u ? 1u : kMappedOutputs;
  float energy = 0.0;
  for (uint c = 0u; c < transfer.channels; ++c)
    for (uint j = 0u; j < rows; ++j) {
      uint value = transfer.first_value + (c * transfer.outputs + j) * transfer.columns + first;
      for (uint m = 0u; m < count; ++m) {
        float one = cosineOverPi(j) * decoded(transfer, at, position, value + m);
        energy += one * one;
      }
    }
  return energy / (float(transfer.channels) * (rows == 1u ? 1.0 : kFourPi));
}
#endif

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
#elif LAMBENT_VALUE == 1
  float value = dcOf(transfer, at, position);
#else
  float value = energyOf(transfer, at, position);
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
