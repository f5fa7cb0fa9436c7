// One text for C++ and GLSL: what the proxy levels of detail of bundles bind and read (std430, scalars only but for groups).
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

LAMBENT_CONSTANT kBindProxyLodView = 0u;  // uniform block
LAMBENT_CONSTANT kBindProxyLodGroups = 0u;
LAMBENT_CONSTANT kBindProxyLodTriangles = 1u;

// A rigid group; its frame is that of the proxy.
struct ProxyLodGroup {
  mat4 world_from_group;
  vec4 light[9];  // world axes, bands 0..2 of what arrives
};

// Group frame, counter-clockwise from the side that is seen.
struct ProxyLodTriangle {
  float corners[9];
  float reflectance[3];
  float emission[3];  // radiance that its lamp gives now
  uint group;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ProxyLodGroup) == 208 && sizeof(ProxyLodTriangle) == 64);
}  // namespace lambent::frame
#endif
