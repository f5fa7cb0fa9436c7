// The room baker/light_probes chooses the light probes of a group: points at which the runtime samples the
// light that comes in from outside, and the weights by which each sample of the group blends them (Sloan,
// Kautz and Snyder 2002, section 6.1). The group's samples, their areas and the planned count come in; points
// and weights per cell go out. A single point stands for light at infinity. Weights consider all points of
// the group, so light has no seam where cells meet. It works on several threads and has no errors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/plan/local_light.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::baker {

// Blends the light of several light probes at a point. The weights are smooth in space, sparse, and sum to 1.

struct BlendWeights {
  std::array<std::uint32_t, transfer::kLightsPerSample> light{};
  std::array<double, transfer::kLightsPerSample> weight{};  // falling; unused ones are 0
};

// Returns the weights, none negative, that minimize
//   |sum_k w_k x_k - p|² + lambda sum_k w_k (|x_k - p|² + e_k),
// where x_k are the light probes and p is the place. What varies linearly in space is blended exactly where
// light probes surround p, and the second term prefers near ones. Lifted to the paraboloid over the x_k, the
// weights are barycentric coordinates in the (regular) Delaunay tetrahedralization at a point near p: at most
// four are nonzero, and they have no jumps. e_k in [0, eps_m2) is a hash of x_k, and decides if more than
// four would do.
BlendWeights blendWeights(glm::vec3 place, std::span<const glm::vec3> lights, double eps_m2);

// These weights are in steps of 1/255, sum to 255 exactly (largest remainder), and descend. Weights that
// round to 0 name light 0. `light` keeps the numbers of BlendWeights.
struct QuantizedWeights {
  std::array<std::uint32_t, transfer::kLightsPerSample> light{};
  std::array<std::uint8_t, transfer::kLightsPerSample> weight{};
};
QuantizedWeights quantized(const BlendWeights& weights);

// Returns those of `lights` that can have a weight at some place inside the box.
std::vector<std::uint32_t> lightsNear(glm::vec3 box_min, glm::vec3 box_max,
                                      std::span<const glm::vec3> lights);

// Chooses where to sample incoming light: at the centres of clusters of surface points by Lloyd's algorithm,
// which is what Sloan, Kautz and Snyder 2002, section 6.1 call ICP. The same points give the same centres. A
// centre is the mean of its points and not the nearest of them, so it lies a little inside of a bent surface
// and neither touches what the body stands on nor comes as near to a light as the surface does. Measured on
// spheres and boxes under a point light with 4 to 32 centres: the error is within 15 % of that of points on
// the surface up to a half-size of half the light's distance, and smaller at 0.8 of it. fitPoints() then
// moves the centres to where their blends fit.

// Returns at most `count` centres, fewer if there are fewer distinct points, and at least one unless `points`
// is empty. Each is the mean of its points by area; points of area 0 count only if all have none.
std::vector<glm::vec3> lightPoints(std::span<const glm::vec3> points, std::span<const float> areas,
                                   std::size_t count);

// Merges points that are closer to each other than `distance` into one of them.
void mergePoints(std::vector<glm::vec3>& points, float distance);

// Moves light probes to where their blends represent the surface best. Fields that vary linearly in space are
// blended as at the point that the weights add up to, so this point should lie on the surface. The fit
// alternates between weights for given points and points for given weights, which are the least squares
//   min over x of sum_p a_p (|sum_k w_pk x_k - p|² + mu sum_k w_pk |x_k - p|²)
// with a_p the area of sample p. Means of clusters lie inside of a bent surface and blends of them deeper
// still. Fitting moves them out, but no farther than `depth` below the nearest surface unless they were
// farther out before (as means of flat clusters are). So no light probe gets into what a body stands on or
// leans against.

// `points` are all light probes of a group, metres; `areas` comes from sampleAreas; `eps_m2` is that of
// blendWeights. A sample set without normals has no inside, so points go where they fit. The result is the
// same for any number of threads.
void fitPoints(std::vector<glm::vec3>& points, const SampleSet& samples, std::span<const float> areas,
               double eps_m2, float depth_m);

struct LightProbes {
  struct Cell {
    std::vector<std::uint32_t> points;  // rising; at most bundle::kMaxLightProbes
    std::vector<transfer::LightWeights>
        weights;  // one per sample of the cell; empty where there is one point
  };
  std::vector<glm::vec3> points;  // as SampleSet::positions; some cell uses each
  std::vector<Cell> cells;        // as SampleSet::cells
};

// `areas` comes from sampleAreas; the bounds are those of the group. Returns fewer than asked for if there
// are fewer distinct points, or if a cell would be lit from more than a bundle holds.
LightProbes chooseLightProbes(const SampleSet& samples, std::span<const float> areas, glm::vec3 bounds_min,
                              glm::vec3 bounds_max, LightProbeCount count);

}  // namespace lambent::baker
