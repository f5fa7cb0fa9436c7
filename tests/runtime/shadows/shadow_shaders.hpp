// The shaders that look up shadows of local lights and key lights, as C++.
#pragma once

#include <functional>

#include "runtime/shadows/local_shared.h"
#include "tests/runtime/shadows/key_maps.hpp"
#include "tests/support/glsl/glsl.hpp"

namespace lambent::frame::glsl {

using namespace lambent::glsl;

struct LocalShader {
  std::function<float(int face, ivec2 texel)> distance_at;  // reads the light's cube
  float localDistance(int, int face, ivec2 texel) { return distance_at(face, texel); }
#include "as_cpp/local_shadow.glsl"
};

struct KeyShader {
  const MadeMap* map = nullptr;
  // Places that are no numbers give any texel on the GPU, too.
  float keyDepth(ivec2 texel) { return map->keyDepth(clamp(texel, 0, map->size - 1)); }
  vec2 keyBlockers(ivec2 texel, int level) {
    return map->keyBlockers(clamp(texel, 0, (map->size / int(kBlockerTexels) >> level) - 1), level);
  }
#include "as_cpp/key_light.glsl"
};

}  // namespace lambent::frame::glsl
