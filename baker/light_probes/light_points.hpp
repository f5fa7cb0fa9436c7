// Chooses where to sample incoming light: at the centres of clusters of surface points by Lloyd's algorithm,
// which is what Sloan, Kautz and Snyder 2002, section 6.1 call ICP. The same points give the same centres. A
// centre is the mean of its points and not the nearest of them, so it lies a little inside of a bent surface
// and neither touches what the body stands on nor comes as near to a light as the surface does. Measured on
// spheres and boxes under a point light with 4 to 32 centres: the error is within 15 % of that of points on
// the surface up to a half-size of half the light's distance, and smaller at 0.8 of it. fit_points.hpp then
// moves the centres to where their blends fit.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::baker {

// Returns at most `count` centres, fewer if there are fewer distinct points, and at least one unless `points`
// is empty. Each is the mean of its points by area; points of area 0 count only if all have none.
std::vector<glm::vec3> lightPoints(std::span<const glm::vec3> points, std::span<const float> areas,
                                   std::size_t count);

// Merges points that are closer to each other than `distance` into one of them.
void mergePoints(std::vector<glm::vec3>& points, float distance);

}  // namespace lambent::baker
