// The record of a local light that shaders read (local_shared.h), and the light that it gives, by the
// shaders' own text. World axes, metres; shares are E/pi for unit power (candela, or radiance of a surface).
// No GL.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/base/glsl.hpp"
#include "runtime/lighting/local_light.hpp"
#include "runtime/shadows/local_shared.h"

namespace lambent::frame {

inline bool hasExtent(const lighting::ShadowedLight& light) {
  return light.kind == lighting::ShadowedLight::Kind::Sphere ||
         light.kind == lighting::ShadowedLight::Kind::Disc;
}

inline bool hasDirection(const lighting::ShadowedLight& light) {
  return light.kind == lighting::ShadowedLight::Kind::Spot ||
         light.kind == lighting::ShadowedLight::Kind::Disc;
}

// Returns whether the light gives any light. One with a value that is not finite gives none.
inline bool shines(const lighting::ShadowedLight& light) {
  const auto finite = [](glm::vec3 v) { return std::isfinite(v.x + v.y + v.z); };
  return finite(light.power) && finite(light.position_ws) && finite(light.direction_ws) &&
         light.power != glm::vec3(0.0f) &&
         (!hasExtent(light) || (light.radius_m > 0.0f && std::isfinite(light.radius_m)));
}

// Returns the distance at which its light ends. Lights with an extent have no limit.
inline float rangeOf(const lighting::ShadowedLight& light) {
  return !hasExtent(light) && light.range_m > 0.0f ? light.range_m : std::numeric_limits<float>::infinity();
}

inline ShadowedLightRecord recordOf(const lighting::ShadowedLight& light, float reach) {
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
