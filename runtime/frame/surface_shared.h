// One text for C++ and GLSL: what the raster pass binds and reads. Words are 32 bits from the start of an arena page.
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

LAMBENT_CONSTANT kBindView = 0u;      // uniform block ViewBlock
LAMBENT_CONSTANT kBindDraws = 0u;     // SurfaceDraw
LAMBENT_CONSTANT kBindGeometry = 1u;  // arena page
LAMBENT_CONSTANT kBindRadiance = 2u;  // arena page
LAMBENT_CONSTANT kAbsent = 0xffffffffu;

LAMBENT_CONSTANT kAlphaOpaque = 0u;  // alpha is 1
LAMBENT_CONSTANT kAlphaMask = 1u;    // below the cutoff nothing is there
LAMBENT_CONSTANT kAlphaBlend = 2u;

struct SurfaceDraw {
  mat4 world_from_mesh;
  vec4 base_color;
  uint positions_word;
  uint texcoords_word;  // of the set that the material names
  uint colors_word;
  uint radiance_word;
  uint alpha_mode;
  float alpha_cutoff;
  uint textured;
  uint pad;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(SurfaceDraw) == 112 && offsetof(SurfaceDraw, positions_word) == 80);
}  // namespace lambent::frame
#endif
