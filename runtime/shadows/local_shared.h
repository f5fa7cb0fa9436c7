// This file is shared by C++ and GLSL. It holds the bindings and records for shading by local lights, besides
// surface_shared.h. World axes, metres.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace lambent::frame {
using uint = std::uint32_t;
using glm::mat4;
using glm::vec3;
using glm::vec4;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kBindShadowedLights = 3u;  // uniform block LocalBlock
LAMBENT_CONSTANT kBindShadowFace = 4u;      // uniform block ShadowFace
LAMBENT_CONSTANT kBindLocalDraws = 5u;      // array of LocalDraw
LAMBENT_CONSTANT kUnitLocalShadows = 8u;    // texture unit of the shadow cubes

LAMBENT_CONSTANT kShadowedLights = 8u;  // lighting::kMaxShadowedLights

// These are the values of scene::LocalLightComponent::Kind.
LAMBENT_CONSTANT kLocalPoint = 0u;
LAMBENT_CONSTANT kLocalSpot = 1u;
LAMBENT_CONSTANT kLocalSphere = 3u;
LAMBENT_CONSTANT kLocalDisc = 4u;

struct ShadowedLightRecord {
  vec3 position;
  float reach;  // distance of depth 1 in the shadow cube; casters are nearer
  vec3 direction;
  uint kind;
  vec3 power;
  float radius;
  float cos_outer, cone_scale;  // factor of a spot: clamp((cos - cos_outer) * cone_scale, 0, 1)^2
  float range;                  // 0: unlimited
  float pad;
};

// This is the uniform block's head, before kShadowedLights records.
struct ShadowView {
  mat4 view_from_clip, world_from_view;
  float width, height;  // of the picture, in pixels
  uint size;            // texels along an edge of a cube's face
  uint samples;         // sample points on a light with an extent
};

// Names the lights of one draw of the surface pass.
struct LocalDraw {
  vec4 world_from_group;  // quaternion, xyz then w
  uint lights;            // bit k: lit by light k
  uint pad0, pad1, pad2;
};

// Describes one face of one cube, while it is drawn.
struct ShadowFace {
  vec3 right;
  float clip_near;  // distance of the near clip plane
  vec3 up;
  float reach;
  vec3 forward;
  float hole;  // surfaces nearer to the light than this are not drawn
  vec3 position;
  float behind;  // 1: surfaces behind the light's plane are not drawn
  vec3 direction;
  float pad;
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ShadowedLightRecord) == 64 && offsetof(ShadowedLightRecord, cos_outer) == 48);
static_assert(sizeof(ShadowView) == 144 && sizeof(LocalDraw) == 32 && sizeof(ShadowFace) == 80);
}  // namespace lambent::frame
#endif
