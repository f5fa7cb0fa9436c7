// How much of a light's disc is hidden: directions spread over it, looked up in the drawn cube maps, and what
// the visible ones say about the light's shape. Comes in: a query, the tiles of its point. Goes out: pixels
// and depths for the GPU; from the bits that come back, the visible share and a correction of the light. No
// GL.
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

// A surface that lies as far away as the light itself, give or take this share, does not hide it.
inline constexpr double kSameDistance = 1e-3;

// For the GPU: bit i of a word says whether something is nearer than the light along direction i.
struct Lookup {
  std::uint32_t pixel = kNoPixel;  // x | y << 16
  std::uint32_t depth_bits = 0;    // of a float: near / w, reversed
};

// Unit directions of equal solid angle over the disc; one for radius 0.
std::vector<glm::vec3> discDirections(const LightQuery& query);

// kLookupsPerWord entries for each of the point's queries.
void appendLookups(std::uint32_t size, std::uint32_t subsamples, const PlannedPoint& planned,
                   std::span<const Tile> tiles, const CapturePoint& point, std::vector<Lookup>& lookups);

// The share that is visible. Where it is neither 0 nor 1, adds
//   radiance Omega (mean over visible directions of y · visible - visible · mean over all of y)
// to `light`, so that `visible` times the disc in closed form plus this has the visible part's shape.
float visibleShare(const LightQuery& query, std::uint32_t hidden_bits, sh::LightVector& light);

}  // namespace lambent::lighting::capture
