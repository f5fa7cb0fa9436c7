// Moves light probes to where their blends stand for the surface best: fields that vary evenly in space are
// blended as at the place that the weights add up to, so these places should be the surface's. Alternates
// between weights for given points and points for given weights, which are the least squares
//   min over x of sum_p a_p (|sum_k w_pk x_k - p|² + mu sum_k w_pk |x_k - p|²)
// with a_p the area of sample p. Means of clusters lie inside of a bent surface and blends of them deeper
// still: fitting moves them out, but none of them out of the body: not beyond where the surface near to it
// lies less `depth`, unless it was there before (means of flat clusters lie on the surface). So no light
// sample comes into what a body stands on or leans against.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/samples.hpp"

namespace lambent::baker {

// All points of a group, metres; `areas` as sampleAreas gives them; eps_m2 as blendWeights takes it. A sample
// set without normals has no inside: points go where they fit. The same for any number of threads.
void fitPoints(std::vector<glm::vec3>& points, const SampleSet& samples, std::span<const float> areas,
               double eps_m2, float depth_m);

}  // namespace lambent::baker
