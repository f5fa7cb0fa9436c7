// Moves light probes to where their blends represent the surface best. Fields that vary linearly in space are
// blended as at the point that the weights add up to, so this point should lie on the surface. The fit
// alternates between weights for given points and points for given weights, which are the least squares
//   min over x of sum_p a_p (|sum_k w_pk x_k - p|² + mu sum_k w_pk |x_k - p|²)
// with a_p the area of sample p. Means of clusters lie inside of a bent surface and blends of them deeper
// still. Fitting moves them out, but no farther than `depth` below the nearest surface unless they were
// farther out before (as means of flat clusters are). So no light probe gets into what a body stands on or
// leans against.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/samples.hpp"

namespace lambent::baker {

// `points` are all light probes of a group, metres; `areas` comes from sampleAreas; `eps_m2` is that of
// blendWeights. A sample set without normals has no inside, so points go where they fit. The result is the
// same for any number of threads.
void fitPoints(std::vector<glm::vec3>& points, const SampleSet& samples, std::span<const float> areas,
               double eps_m2, float depth_m);

}  // namespace lambent::baker
