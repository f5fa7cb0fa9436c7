// One text for C++ and GLSL: what direct light of key lights binds and reads, besides surface_shared.h. Metres. Axes are
// the camera's (view space), so that large worlds lose no precision.
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

LAMBENT_CONSTANT kBlockerTexels = 8u;  // texels of a depth map along an edge of one of the pyramid's finest
LAMBENT_CONSTANT kBlockerGroup = 8u;   // work group of key_blockers.comp, along an edge

LAMBENT_CONSTANT kBindKeyMap = 4u;  // uniform block KeyMapView, while a map is drawn

// A disc of light at infinity, and its shadow map: an orthographic picture of the world as the light sees it. What is
// stored is depth below the map's top over `range`; 1 is nothing.
struct KeyRecord {
  vec4 right;     // texels of the texture from a point p: dot(xyz, p) + w
  vec4 up;
  vec4 towards;   // unit, to the light; depth of p below the map's top: w - dot(xyz, p)
  vec4 radiance;  // w: sine of the disc's angular radius
  vec4 tile;      // first texel, last texel: places are clamped to their centres
  vec4 scale;     // texels per metre along right and up; w: tangent of the angular radius; z: range of depth
  uint rays;      // to the disc, from a point in its penumbra
  uint pad0, pad1, pad2;
};

struct KeyView {
  mat4 view_from_clip;
  mat4 view_from_world;  // rotation
  vec4 picture;          // width, height in pixels
  uint count;
  uint pad0, pad1, pad2;
};

// Of a map while it is drawn: clip coordinates from the world.
struct KeyMapView {
  mat4 clip_from_world;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(KeyRecord) == 112 && sizeof(KeyView) == 160 && offsetof(KeyView, count) == 144);
}  // namespace lambent::frame
#endif
