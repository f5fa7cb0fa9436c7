// Measures triangles, and how much of the surface each sample stands for.
#pragma once

#include <vector>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Returns a normal that is twice the triangle's area long, in square metres.
glm::vec3 areaNormal(const GroupGeometry& geometry, const glm::uvec3& corners);
// Returns square metres.
double triangleArea(const GroupGeometry& geometry, const glm::uvec3& corners);
// Returns metres.
float longestEdge(const GroupGeometry& geometry, const glm::uvec3& corners);

// Returns square metres per sample; a third of each triangle goes to each of its corners, or all of it in
// equal parts to its texels. Both sides of a double-sided surface count.
std::vector<float> sampleAreas(const GroupGeometry& geometry, const SampleSet& samples);

}  // namespace lambent::baker
