// Multiplies transfer vectors with light. It holds the mathematics only and no bindings. The CPU twin is in
// transfer_ref.hpp.
#include "transfer_shared.h"

const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);  // Rec. 709

vec3 lightAt(uint index);  // coefficient of the light, RGB, group frame
float vectorAt(uint word);  // word of the transfer page

// Multiplies `columns` values from word `at` on with `rest` of the light from index `light` on, plus `key` of the key
// lights, which lie kKeyBlock further. Returns one value per colour channel.
vec3 timesLight(uint at, uint channels, uint stride, uint columns, uint light, float rest, float key) {
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < columns; ++i) {
    vec3 arriving = rest * lightAt(light + i);
    if (key != 0.0) arriving += key * lightAt(light + kKeyBlock + i);
    vec3 value = vec3(vectorAt(at + i));
    if (channels > 1u) value.gb = vec2(vectorAt(at + stride + i), vectorAt(at + 2u * stride + i));
    sum += value * arriving;
  }
  return sum;
}

// Returns one output of a mean or axis times the light whose coefficients start at `light`, per colour channel. Light
// that comes straight from key lights is left out; w holds its luminance.
vec4 projectOnLight(TransferRecord transfer, uint vector, uint output_index, uint columns, uint light) {
  uint first = transfer.vectors_word + vector * transfer.vector_size + output_index * columns;
  uint stride = transfer.outputs * columns;
  vec3 sum = timesLight(first + transfer.first_value, transfer.channels, stride, columns, light, 1.0, float(transfer.bounced));
  if (transfer.straight_channels == 0u) return vec4(sum, 0.0);
  vec3 straight = timesLight(first, transfer.straight_channels, stride, columns, light, 0.0, 1.0);
  return vec4(sum - float(transfer.bounced) * straight, dot(straight, kLuminance));
}
