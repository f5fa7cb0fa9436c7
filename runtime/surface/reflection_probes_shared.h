// This file is shared by C++ and GLSL. It holds the binding points of reflection probes, for the kernels that
// make them and for the surfaces that look them up.
#ifdef __cplusplus
#pragma once

#include <cstdint>

#include <glm/vec4.hpp>

namespace lambent::frame {
using uint = std::uint32_t;
using glm::vec4;
#define LAMBENT_CONSTANT inline constexpr uint
#else
#define LAMBENT_CONSTANT const uint
#endif

LAMBENT_CONSTANT kMostProbes = 16u;
LAMBENT_CONSTANT kProbeLevels =
    7u;  // mip levels, each with its roughness: as many as the prefiltered environment
LAMBENT_CONSTANT kBindProbes = 7u;         // uniform block ProbeBlock
LAMBENT_CONSTANT kUnitProbesLayered = 4u;  // texture units that these receivers do not use
LAMBENT_CONSTANT kUnitProbesGlossy = 6u;

// These are bindings of the kernels.
LAMBENT_CONSTANT kProbeGroup = 8u;  // edge of a work group
LAMBENT_CONSTANT kBindProbeLobe = 0u;
LAMBENT_CONSTANT kProbeShares = 256u;  // equal shares of the lobe, of which a kernel takes some
LAMBENT_CONSTANT kVoxelGroup = 64u;
LAMBENT_CONSTANT kBindVoxelGeometry = 0u;
LAMBENT_CONSTANT kBindVoxelWords = 1u;

// Has the std140 layout of the uniform block. The images of probe i are layer i of an array of cubes: what it
// sees, as radiance and coverage, premultiplied, with roughness along the levels. Layer `count` + i has 1 /
// distance in metres, and 0 where it sees the sky.
struct ProbeValues {
  vec4 counts;               // x: layers of each kind; y: 1 if surfaces look probes up
  vec4 places[kMostProbes];  // world; w: 1 if the probe has been captured
};

#ifdef __cplusplus
#undef LAMBENT_CONSTANT
static_assert(sizeof(ProbeValues) == 16 + 16 * kMostProbes);
}  // namespace lambent::frame
#endif
