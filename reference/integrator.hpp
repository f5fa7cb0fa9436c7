// Traces the paths of one pixel. At every vertex it samples one direction from the BRDF (for a diffuse
// surface, from the cosine), one direction towards discs and environment maps, one towards each sphere and
// disc light in the scene, one point on an emissive triangle, and one punctual light, combined by multiple
// importance sampling (Veach's power heuristic). At a vertex in a volume the phase function replaces the
// BRDF. With `--band-limit IN,OUT` the first hit's response to the unoccluded sky is exact, and paths only
// find what is blocked. The transmittance of volumes along eye rays is exact, too, so coverage has no noise.
//
// All samples of a pixel in one call advance together, so that their rays are traced in packets. Samples
// alternate between two independent replicas, which gives an unbiased error estimate of their mean. One
// Integrator serves all threads.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "reference/options.hpp"
#include "reference/world.hpp"

namespace lambent::baker::reference {

struct PixelSum {
  std::array<glm::dvec3, 2> replicas{};  // sum of the samples of each replica
  double alpha = 0.0;                    // coverage; not a sum
  // Depth of the first opaque surface along the camera's axis, in metres; not a sum.
  double depth = std::numeric_limits<double>::infinity();
  std::uint64_t rays = 0;
};

class Integrator {
 public:
  Integrator(const World& world, const Options& options) : world_(world), options_(options) {}

  // Traces samples first..first + count - 1 of the pixel. Even samples belong to replica 0.
  PixelSum pixel(std::uint32_t x, std::uint32_t y, std::uint32_t first, std::uint32_t count) const;

 private:
  const World& world_;
  const Options& options_;
};

}  // namespace lambent::baker::reference
