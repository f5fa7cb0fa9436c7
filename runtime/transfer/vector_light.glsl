// Transfer vectors times light: the math only, no bindings. The CPU twin stands in transfer_ref.hpp.
#include "transfer_shared.h"

const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);  // Rec. 709

vec3 lightAt(uint index);  // coefficient of the light in the group's frame, RGB
float vectorAt(uint word);  // of the transfer page

// A stretch of `columns` values from this word on times the light from this index on, plus as much of the light that
// lies kKeyBlock behind it: one value per colour channel.
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

// One output of a mean or axis times the light whose coefficients start at `light`: one value per colour channel. Light
// that comes straight from key lights is not in it; its luminance is w.
vec4 projectOnLight(TransferRecord transfer, uint vector, uint output_index, uint columns, uint light) {
  uint first = transfer.vectors_word + vector * transfer.vector_size + output_index * columns;
  uint stride = transfer.outputs * columns;
  vec3 sum = timesLight(first + transfer.first_value, transfer.channels, stride, columns, light, 1.0, float(transfer.bounced));
  if (transfer.straight_channels == 0u) return vec4(sum, 0.0);
  vec3 straight = timesLight(first, transfer.straight_channels, stride, columns, light, 0.0, 1.0);
  return vec4(sum - float(transfer.bounced) * straight, dot(straight, kLuminance));
}
