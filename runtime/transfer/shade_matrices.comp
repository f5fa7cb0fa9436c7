// Stage b for matrices: adds the mean's product and code times product over the resident planes, for each light probe
// that shares in the sample. There are LAMBENT_BANDS invocations per position of the dirty cells, each with
// LAMBENT_BANDS outputs: so neighbours write adjacent values, the outputs fit the registers, and a code is decoded
// once for several outputs.
#include "transfer_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindTransfers) readonly buffer Transfers { TransferRecord transfers[]; };
layout(std430, binding = kBindPlaces) readonly buffer Places { uint places[]; };
layout(std430, binding = kBindProducts) readonly buffer Products { vec4 products[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { uint page[]; };
layout(std430, binding = kBindSamples) buffer Samples { vec4 samples[]; };

#include "coded_transfer.glsl"

uint codeWordAt(uint word) { return page[word]; }

const uint kOutputs = LAMBENT_BANDS * LAMBENT_BANDS;

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  TransferRecord transfer = transfers[work[index].record];
  uint element = work[index].first + gl_LocalInvocationID.x;
  uint position = element / LAMBENT_BANDS, first_output = element % LAMBENT_BANDS * LAMBENT_BANDS;
  if (position >= transfer.sample_count) return;
  CodedSample at = codedSampleAt(transfer, position);
  vec4 light[LAMBENT_BANDS];
  for (uint j = 0u; j < LAMBENT_BANDS; ++j) light[j] = vec4(0.0);
  for (uint k = 0u; k < kLightsPerSample; ++k) {
    LightShare share = lightShareOf(transfer, at.sample_index, k);
    if (share.weight == 0.0) break;
    uint product = transfer.first_product + transfer.light_products * share.light + kOutputs * at.first + first_output;
    for (uint j = 0u; j < LAMBENT_BANDS; ++j) light[j] += share.weight * products[product + j];
    for (uint axis = 0u; axis < at.axes; ++axis) {
      product += kOutputs;
      float weight = float(codeOf(places[transfer.first_plane + axis], position)) * share.weight;
      for (uint j = 0u; j < LAMBENT_BANDS; ++j) light[j] += weight * products[product + j];
    }
  }
  uint out_index = transfer.first_output + kOutputs * at.sample_index + first_output;
  for (uint j = 0u; j < LAMBENT_BANDS; ++j) {
    if (transfer.accumulate != 0u) light[j] += samples[out_index + j];
    samples[out_index + j] = light[j];
  }
}
