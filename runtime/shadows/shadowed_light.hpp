// The record of a local light that shaders read (local_shared.h), and the light that it gives, by the
// shaders' own text. World axes, metres; shares are E/pi for unit power (candela, or radiance of a surface).
// No GL.
#pragma once

#include <algorithm>
#include <cmath>

#include "runtime/base/glsl.hpp"
#include "runtime/lighting/local_light.hpp"
#include "runtime/shadows/local_shared.h"

namespace lambent::frame {

inline ShadowedLightRecord recordOf(const lighting::LocalLight& light, float reach) {
  const float inner = std::cos(light.inner_cone_rad), outer = std::cos(light.outer_cone_rad);
  return {.position = light.position_ws,
          .reach = reach,
          .direction = light.direction_ws,
          .kind = static_cast<uint>(light.kind),
          .power = light.power,
          .radius = light.radius_m,
          .cos_outer = outer,
          .cone_scale = 1.0f / std::max(0.001f, inner - outer),
          .range = std::isinf(rangeOf(light)) ? 0.0f : light.range_m,
          .pad = 0.0f};
}

}  // namespace lambent::frame

namespace lambent::frame::glsl {

using namespace lambent::glsl;

struct UnshadowedLight {
#include "as_cpp/shadowed_light.glsl"
};

}  // namespace lambent::frame::glsl
