// Evaluates samples without transfer. It holds the mathematics only and no bindings. The CPU twin is glossy_ref.hpp.
#include "glossy_shared.h"

const float kSqrtFourPi = 3.5449077018110318;

vec3 lightAt(uint index);

// Returns one output of an open sample: all of the light, and visibility 1. For a neighborhood both are 0, no change.
vec4 openLight(FillRecord fill, uint output_index) {
  vec3 light = output_index < fill.coefficients ? lightAt(fill.light + output_index) : vec3(0.0);
  return vec4(light, output_index == 0u && fill.open != 0u ? kSqrtFourPi : 0.0);
}
