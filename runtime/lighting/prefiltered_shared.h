// This file is shared by C++ and GLSL. It holds the binding points of the prefiltered environment, for the
// kernels that make it and for the surfaces that look it up.
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

LAMBENT_CONSTANT kReflectedLevels = 7u;        // mip levels, each with its roughness
LAMBENT_CONSTANT kBindReflection = 5u;         // uniform block ReflectionBlock
LAMBENT_CONSTANT kUnitFirstReflection = 9u;    // texture unit of the first set of lights
LAMBENT_CONSTANT kUnitSecondReflection = 10u;  // texture unit of the second set
LAMBENT_CONSTANT kUnitFirstWhole = 14u;        // the same with key lights, if these are wide
LAMBENT_CONSTANT kUnitSecondWhole = 15u;
LAMBENT_CONSTANT kReflectionCoefficients = 36u;

// These are bindings of prefiltered_environment.comp, which makes one level of one cube at a time.
LAMBENT_CONSTANT kBindLobe = 0u;        // angles of equal shares of the lobe
LAMBENT_CONSTANT kBindDiscs = 1u;       // array of ReflectedDisc
LAMBENT_CONSTANT kReflectedGroup = 8u;  // edge of a work group

struct ReflectedDisc {
  vec4 direction_and_radius;  // lights' own frame; w: radius in radians
  vec4 radiance;
};

// Has the std140 layout of the uniform block.
struct ReflectionValues {
  mat4 light_from_world;
  vec4 shares;  // x, y: of the two sets; z: last level; w: 1 if there are pictures with key lights
  vec4 bands[2u * kReflectedLevels];    // factors on bands 0..5 for each level; two of eight unused
  vec4 light[kReflectionCoefficients];  // the light that surfaces have in bands, world axes
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ReflectionValues) == 64 + 16 + 224 + 576);
}  // namespace lambent::lighting
#endif
