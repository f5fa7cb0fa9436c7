// Samples without transfer: the math only, no bindings. The CPU twin is glossy_ref.hpp.
#include "glossy_shared.h"

const float kSqrtFourPi = 3.5449077018110318;

vec3 lightAt(uint index);

// An open sample: all of the light, and visibility 1. Of a neighborhood: no change of either.
vec4 openLight(FillRecord fill, uint output_index) {
  vec3 light = output_index < fill.coefficients ? lightAt(fill.light + output_index) : vec3(0.0);
  return vec4(light, output_index == 0u && fill.open != 0u ? kSqrtFourPi : 0.0);
}
