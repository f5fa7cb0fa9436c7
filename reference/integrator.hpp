// Paths: what one pixel's samples see. At every vertex: one direction by the surface (diffuse: by the
// cosine), weighed against one towards discs and probes, one towards each sphere and disc of light in the
// scene, one point on an emissive triangle and one punctual light (Veach's multiple importance sampling,
// power heuristic). Where a volume scatters, its phase function stands in for the surface. With
// `--band-limit IN,OUT` the first hit's answer to the open sky is exact, and paths only find what blocks it.
// What volumes let through to the eye is exact too, so coverage has no noise.
// All samples of a pixel that are asked for together walk in step, so that their rays travel in packets. A
// pixel's samples belong to two independent replicas in turn, which gives the error of their mean without
// bias. One Integrator serves all threads.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "reference/options.hpp"
#include "reference/world.hpp"

namespace lambent::baker::reference {

struct PixelSum {
  std::array<glm::dvec3, 2> replicas{};  // sums over the samples of each
  double alpha = 0.0;                    // coverage, not a sum
  // Along the camera's axis, of the first surface that is not blended; metres, not a sum.
  double depth = std::numeric_limits<double>::infinity();
  std::uint64_t rays = 0;
};

class Integrator {
 public:
  Integrator(const World& world, const Options& options) : world_(world), options_(options) {}

  // Samples first..first + count - 1 of the pixel; even ones are the first replica's.
  PixelSum pixel(std::uint32_t x, std::uint32_t y, std::uint32_t first, std::uint32_t count) const;

 private:
  const World& world_;
  const Options& options_;
};

}  // namespace lambent::baker::reference
