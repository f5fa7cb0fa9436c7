// Stage b of all effects adds the mean's product and code times product over the resident planes.
// Vectors have one invocation per position of the dirty cells. Neighbouring positions mostly belong to one cluster and
// so read the same products. With LAMBENT_MANY_LIGHTS each sample blends the products of the light probes around it.
// Matrices (LAMBENT_MATRICES) have LAMBENT_BANDS invocations per position, each with LAMBENT_BANDS outputs: so
// neighbours write adjacent values, the outputs fit the registers, and a code is decoded once for several outputs.
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

#ifdef LAMBENT_MATRICES
const uint kOutputs = LAMBENT_BANDS * LAMBENT_BANDS;
#endif

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  TransferRecord transfer = transfers[work[index].record];
#ifdef LAMBENT_MATRICES
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
#else
  uint position = work[index].first + gl_LocalInvocationID.x;
  if (position >= transfer.sample_count) return;
  CodedSample at = codedSampleAt(transfer, position);
  uint product = transfer.first_product + LAMBENT_OUTPUTS * at.first;
  vec4 light[LAMBENT_OUTPUTS];  // w: luminance straight from key lights
#ifdef LAMBENT_MANY_LIGHTS
  uint products_of[kLightsPerSample];
  float weight[kLightsPerSample];
  uint light_count = 0u;
  for (uint k = 0u; k < kLightsPerSample; ++k) {
    LightShare share = lightShareOf(transfer, at.sample_index, k);
    if (share.weight == 0.0) break;
    weight[k] = share.weight;
    products_of[k] = product + transfer.light_products * share.light;
    light_count = k + 1u;
  }
  for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) light[j] = vec4(0.0);
  for (uint k = 0u; k < light_count; ++k)
    for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) light[j] += weight[k] * products[products_of[k] + j];
  for (uint axis = 0u; axis < at.axes; ++axis) {
    float code = float(codeOf(places[transfer.first_plane + axis], position));
    for (uint k = 0u; k < light_count; ++k) {
      products_of[k] += LAMBENT_OUTPUTS;
      for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) light[j] += code * weight[k] * products[products_of[k] + j];
    }
  }
#else
  for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) light[j] = products[product + j];
  for (uint axis = 0u; axis < at.axes; ++axis) {
    product += LAMBENT_OUTPUTS;
    float code = float(codeOf(places[transfer.first_plane + axis], position));
    for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) light[j] += code * products[product + j];
  }
#endif
  uint out_index = transfer.first_output + LAMBENT_OUTPUTS * at.sample_index;
  for (uint j = 0u; j < LAMBENT_OUTPUTS; ++j) {
    if (transfer.accumulate != 0u)
      light[j] += samples[out_index + j];
    else
      light[j].w = 1.0 + (j == 0u ? max(light[j].w, 0.0) : light[j].w);
    samples[out_index + j] = light[j];
  }
#endif
}
