// Stage a of all effects multiplies the mean and axes of clusters with the light. A work group handles kUnitsPerGroup
// units, each one output of one cluster under one light. The offsets of the weights go into the mean's product and
// their scales into the axes', so that a sample needs one multiply-add per axis and channel. With LAMBENT_VISIBILITY
// vectors are visibility, else transfer vectors or matrices.
#include "transfer_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindLights) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = kBindTransfers) readonly buffer Transfers { TransferRecord transfers[]; };
layout(std430, binding = kBindPlaces) readonly buffer Places { uint places[]; };
layout(std430, binding = kBindProducts) writeonly buffer Products { vec4 products[]; };
layout(std430, binding = kBindTransfer) readonly buffer Transfer { uint page[]; };
#ifdef LAMBENT_VISIBILITY
layout(std430, binding = kBindGaunt) readonly buffer Gaunt { uint gaunt[]; };
#endif

shared vec4 means[kWorkGroupSize];

vec3 lightAt(uint index) { return lights[index].rgb; }
float vectorAt(uint word) { return uintBitsToFloat(page[word]); }

#ifdef LAMBENT_VISIBILITY
// Returns output i of a mean or axis V of visibility under the light whose coefficients start at `light`:
//   l'_i = sum_jk Gamma_ijk V_k l_j.
// w is the same sum under constant light of radiance 1, which is V_i itself.
vec4 projected(TransferRecord transfer, uint vector, uint output_index, uint light) {
  uint at = transfer.vectors_word + vector * transfer.vector_size;
  vec3 sum = vec3(0.0);
  uint first_term = transfer.outputs + 1u, end = gaunt[output_index + 1u];
  for (uint t = gaunt[output_index]; t < end; ++t) {
    uint jk = gaunt[first_term + kGauntTermWords * t];
    float value = uintBitsToFloat(gaunt[first_term + kGauntTermWords * t + 1u]);
    sum += value * vectorAt(at + (jk >> 16u)) * lightAt(light + (jk & 0xffffu));
  }
  return vec4(sum, vectorAt(at + output_index));
}
#else
const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);  // Rec. 709

// Describes a transfer vector in memory: its first word, and the number of words from one channel to the next
// (`stride`).
struct TransferVector {
  uint at, channels, stride, columns;
};

// Names the light that is multiplied: a share of what starts at index `rest`, plus a share of what is shaded per pixel
// and starts at index `key`.
struct ArrivingLight {
  uint rest, key;
  float rest_share, key_share;
};

// Returns the vector times the light, one value per colour channel.
vec3 timesLight(TransferVector vector, ArrivingLight light) {
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < vector.columns; ++i) {
    vec3 arriving = light.rest_share * lightAt(light.rest + i);
    if (light.key_share != 0.0) arriving += light.key_share * lightAt(light.key + i);
    vec3 value = vec3(vectorAt(vector.at + i));
    if (vector.channels > 1u)
      value = vec3(value.r, vectorAt(vector.at + vector.stride + i), vectorAt(vector.at + 2u * vector.stride + i));
    sum += value * arriving;
  }
  return sum;
}

// Returns one output of a mean or axis times the light whose coefficients start at `light`, per colour channel. Light
// that comes straight from lights which are shaded per pixel is left out; w holds its luminance.
vec4 projected(TransferRecord transfer, uint vector, uint output_index, uint light) {
#ifdef LAMBENT_ORDER
  uint columns = LAMBENT_ORDER * LAMBENT_ORDER;
#else
  uint columns = transfer.columns;
#endif
  uint first = transfer.vectors_word + vector * transfer.vector_size + output_index * columns;
  uint stride = transfer.outputs * columns;
  uint key = light + transfer.apart;
  vec3 sum = timesLight(TransferVector(first + transfer.first_value, transfer.channels, stride, columns),
                        ArrivingLight(light, key, 1.0, float(transfer.bounced)));
  if (transfer.straight_channels == 0u) return vec4(sum, 0.0);
  vec3 straight = timesLight(TransferVector(first, transfer.straight_channels, stride, columns),
                             ArrivingLight(light, key, 0.0, 1.0));
  // In samples of glossy surfaces, w is how visible light is.
  float sent_on = transfer.outputs > kMappedOutputs ? 0.0 : dot(straight, kLuminance);
  return vec4(sum - float(transfer.bounced) * straight, sent_on);
}
#endif

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  TransferRecord transfer = transfers[work[index].record];
  uint lane = gl_LocalInvocationID.x % kLanesPerUnit;
  uint unit = work[index].first + gl_LocalInvocationID.x / kLanesPerUnit;
  uint output_index = unit % transfer.outputs, cluster = unit / transfer.outputs % transfer.clusters;
  uint light_index = unit / (transfer.outputs * transfer.clusters);
  bool there = light_index < transfer.light_count;
  uint first_product = transfer.first_product + transfer.light_products * light_index;
  vec4 mean = vec4(0.0);
  uint first = 0u;
  if (there) {
    first = page[transfer.clusters_word + 2u * cluster];
    uint light = places[transfer.first_light + light_index];
    uint axes = min(page[transfer.clusters_word + 2u * cluster + 1u], transfer.plane_count);
    for (uint v = lane; v <= axes; v += kLanesPerUnit) {
      uint vector = first + v;
      vec4 value = projected(transfer, vector, output_index, light);
      mean += vectorAt(transfer.weights_word + 2u * vector) * value;
      if (v > 0u)
        products[first_product + transfer.outputs * vector + output_index] =
            vectorAt(transfer.weights_word + 2u * vector + 1u) * value;
    }
  }
  means[gl_LocalInvocationID.x] = mean;
  barrier();
  if (there && lane == 0u) {
    vec4 total = vec4(0.0);
    for (uint i = 0u; i < kLanesPerUnit; ++i) total += means[gl_LocalInvocationID.x + i];
    products[first_product + transfer.outputs * first + output_index] = total;
  }
}
