// This file is shared by C++ and GLSL. It holds the bindings and records for direct light of key lights,
// besides surface_shared.h. Metres. Axes are the camera's (view space), so that large worlds lose no
// precision.
#ifdef __cplusplus
#pragma once

#include <cstddef>
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

LAMBENT_CONSTANT kBindKeyLights = 6u;     // uniform block KeyBlock
LAMBENT_CONSTANT kUnitKeyShadows = 12u;   // texture unit of the depth maps, tiles of one texture
LAMBENT_CONSTANT kUnitKeyBlockers = 13u;  // texture unit of the pyramid of least and greatest depths
LAMBENT_CONSTANT kMostKeyLights = 64u;

LAMBENT_CONSTANT kBlockerTexels = 8u;  // depth texels along the edge of a texel in the pyramid's finest level
LAMBENT_CONSTANT kBlockerGroup = 8u;   // edge of a work group of key_blockers.comp

LAMBENT_CONSTANT kBindKeyMap = 4u;  // uniform block KeyMapView, bound while a map is drawn

// Describes a disc of light at infinity and its shadow map, an orthographic picture of the world as seen from
// the light. The map stores depth below its top over `range`; 1 means that nothing is there.
struct KeyRecord {
  vec4 right;  // x of a point p in the texture, in texels: dot(xyz, p) + w; `up` gives y
  vec4 up;
  vec4 towards;   // unit, to the light; the depth of p below the map's top is w - dot(xyz, p)
  vec4 radiance;  // w: sine of the disc's angular radius
  vec4 tile;      // first and last texel; lookups are clamped to their centres
  vec4 scale;     // texels per metre along right and up; z: range of depth; w: tangent of the angular radius
  uint rays;      // rays to the disc from a point in its penumbra
  uint pad0, pad1, pad2;
};

struct KeyView {
  mat4 view_from_clip;
  mat4 view_from_world;  // rotation only
  vec4 picture;          // width and height in pixels
  uint count;
  uint pad0, pad1, pad2;
};

// Gives the clip coordinates of a map while it is drawn.
struct KeyMapView {
  mat4 clip_from_world;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(KeyRecord) == 112 && sizeof(KeyView) == 160 && offsetof(KeyView, count) == 144);
}  // namespace lambent::frame
#endif
