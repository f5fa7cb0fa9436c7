// One text for C++ and GLSL: what reflections of the sky bind, when they are made and when surfaces look into
// them.
#ifdef __cplusplus
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace lambent::lighting {
using uint = std::uint32_t;
using glm::mat4;
using glm::vec4;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kReflectedLevels = 7u;        // of roughness, along the mip levels
LAMBENT_CONSTANT kBindReflection = 5u;         // uniform block ReflectionBlock
LAMBENT_CONSTANT kUnitFirstReflection = 9u;    // texture units: of the first set of lights
LAMBENT_CONSTANT kUnitSecondReflection = 10u;  // and of the second
LAMBENT_CONSTANT kUnitFirstWhole = 14u;        // the same with key lights, where these are wide
LAMBENT_CONSTANT kUnitSecondWhole = 15u;
LAMBENT_CONSTANT kReflectionCoefficients = 36u;

// Made by prefiltered_environment.comp, one level of one cube at a time.
LAMBENT_CONSTANT kBindLobe = 0u;        // angles of equal shares of the lobe
LAMBENT_CONSTANT kBindDiscs = 1u;       // ReflectedDisc
LAMBENT_CONSTANT kReflectedGroup = 8u;  // work group, along an edge

struct ReflectedDisc {
  vec4 direction_and_radius;  // in the lights' own frame; radians
  vec4 radiance;
};

// The block as std140 has it.
struct ReflectionValues {
  mat4 light_from_world;
  vec4 shares;  // of the two sets; z: the last level; w: 1 where there are pictures with key lights
  vec4
      bands[2u * kReflectedLevels];  // by what the lobe of each level scales bands 0..5, six of eight numbers
  vec4 light[kReflectionCoefficients];  // the light that surfaces have in bands, world axes
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ReflectionValues) == 64 + 16 + 224 + 576);
}  // namespace lambent::lighting
#endif
