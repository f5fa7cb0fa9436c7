// This file is shared by C++ and GLSL. It says what the proxy levels of detail of bundles bind, and lays out what
// they read (std430; vectors only in ProxyLodGroup).
#ifdef __cplusplus
#pragma once

#include <cstdint>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace lambent::frame {
using uint = std::uint32_t;
using glm::mat4;
using glm::vec4;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindProxyLodGroups = 0u;
LAMBENT_CONSTANT kBindProxyLodTriangles = 1u;

// Describes a rigid group, whose frame is that of its proxy.
struct ProxyLodGroup {
  mat4 world_from_group;
  vec4 light[9];  // incident light of bands 0..2, world axes
};

// Describes a triangle in the group's frame, counter-clockwise from the side that is seen.
struct ProxyLodTriangle {
  float corners[9];
  float reflectance[3];
  float emission[3];  // current radiance of its lamp
  uint group;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ProxyLodGroup) == 208 && sizeof(ProxyLodTriangle) == 64);
}  // namespace lambent::frame
#endif
