// Traces the paths of one pixel's samples. Every vertex draws one direction from the surface's BRDF (a
// diffuse surface's from the cosine), one towards discs and environment maps, one towards each sphere and
// disc of light in the scene, one point on an emissive triangle, and one punctual light, weighted by multiple
// importance sampling (Veach's power heuristic). At a vertex in a volume, the phase function replaces the
// BRDF. With `--band-limit IN,OUT` the first hit's response to the open sky is exact, and paths only find
// what blocks it. What volumes let through to the eye is exact too, so coverage has no noise.
//
// All samples of a pixel in one call advance in step, so that their rays travel in packets. Samples belong to
// two independent replicas in turn, which gives an unbiased error of their mean. One Integrator serves all
// threads.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "reference/options.hpp"
#include "reference/world.hpp"

namespace lambent::baker::reference {

struct PixelSum {
  std::array<glm::dvec3, 2> replicas{};  // sums over the samples of each replica
  double alpha = 0.0;                    // coverage, not a sum
  // Depth of the first surface that is not blended, along the camera's axis; metres, not a sum.
  double depth = std::numeric_limits<double>::infinity();
  std::uint64_t rays = 0;
};

class Integrator {
 public:
  Integrator(const World& world, const Options& options) : world_(world), options_(options) {}

  // Traces samples first..first + count - 1 of the pixel; even ones belong to the first replica.
  PixelSum pixel(std::uint32_t x, std::uint32_t y, std::uint32_t first, std::uint32_t count) const;

 private:
  const World& world_;
  const Options& options_;
};

}  // namespace lambent::baker::reference
