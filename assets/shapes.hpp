// The plain shapes of the scenes. Per-vertex transfer wants vertices where shadows change, so everything
// takes the length of an edge; edges of neighbouring faces are cut alike, so that boxes and spheres are
// closed.
#pragma once

#include <functional>
#include <span>

#include "assets/mesh.hpp"

namespace lambent::assets {

// A flat quad of cells_u x cells_v cells; its normal is edge_u x edge_v. Texture coordinates are in metres.
Mesh plane(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, int cells_u, int cells_v);

// As plane(), with cells of about `cell`.
Mesh plane(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, float cell);

Mesh box(glm::vec3 low, glm::vec3 high, float cell);

// A cube of cells x cells faces blown up: no poles.
Mesh sphere(float radius, int cells);

// A profile (radius, height) turned about +Y, from the bottom to the top, outside on the right of the way.
// Every corner of the profile is a sharp edge; its pieces are cut into lengths of about `cell`. Closed where
// the profile starts and ends on the axis.
Mesh lathe(std::span<const glm::vec2> profile, int segments, float cell);

// Every vertex as a function of (u, v) in [0, 1]²: shared by the curved shapes. (du x dv) must point outside.
struct SurfacePoint {
  glm::vec3 position, normal;
};
Mesh surface(int cells_u, int cells_v, const std::function<SurfacePoint(double u, double v)>& point);

}  // namespace lambent::assets
