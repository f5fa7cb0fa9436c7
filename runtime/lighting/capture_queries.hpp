// Measures how much of a light's disc bodies hide. Directions spread over the disc are looked up in the drawn
// cube maps, and the visible ones also correct the shape of the light. appendLookups() turns a query and the
// tiles of its point into pixels and depths for the GPU; visibleShare() turns the bits that come back into
// the visible share and the correction. No GL.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/lighting/capture_plan.hpp"
#include "runtime/lighting/capture_scene.hpp"
#include "runtime/lighting/capture_shared.h"
#include "runtime/sh/light_vector.hpp"

namespace lambent::lighting::capture {

// A surface does not hide the light if it is as far away as the light, within this relative tolerance.
inline constexpr double kSameDistance = 1e-3;

// Describes a lookup for the GPU. Bit i of a result word tells whether something is nearer than the light
// along direction i.
struct Lookup {
  std::uint32_t pixel = kNoPixel;  // x | y << 16
  std::uint32_t depth_bits = 0;    // bits of a float: near / w, so larger values are nearer
};

// Returns unit directions that each represent the same solid angle of the disc. Radius 0 gives one direction.
std::vector<glm::vec3> discDirections(const LightQuery& query);

// Appends kLookupsPerWord entries for each of the point's queries.
void appendLookups(std::uint32_t size, std::uint32_t subsamples, const PlannedPoint& planned,
                   std::span<const Tile> tiles, const CapturePoint& point, std::vector<Lookup>& lookups);

// Returns the visible share, 0..1. If it is neither 0 nor 1, adds
//   radiance Omega (mean over visible directions of y · visible - visible · mean over all of y)
// to `light`, so that `visible` times the closed form of the disc plus this term has the shape of the visible
// part.
float visibleShare(const LightQuery& query, std::uint32_t hidden_bits, sh::LightVector& light);

}  // namespace lambent::lighting::capture
