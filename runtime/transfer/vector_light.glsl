// Multiplies transfer vectors with light. It holds the mathematics only and no bindings.
#include "transfer_shared.h"

const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);  // Rec. 709

vec3 lightAt(uint index);  // coefficient of the light, RGB, group frame
float vectorAt(uint word);  // word of the transfer page

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
vec4 projectOnLight(TransferRecord transfer, uint vector, uint output_index, uint columns, uint light) {
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
