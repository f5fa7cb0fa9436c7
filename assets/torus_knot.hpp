// Makes a round tube around the (p, q) torus knot, which winds p times about the axis +Y and q times through
// the hole.
#pragma once

#include "assets/mesh.hpp"

namespace lambent::assets {

struct TorusKnot {
  int p = 2, q = 3;
  float ring_radius = 1.0f;   // of the torus that the knot winds on
  float torus_radius = 0.4f;  // of the tube of that torus
  float tube_radius = 0.15f;
  int cells_along = 300, cells_around = 24;
};

// Makes a closed mesh with analytic normals.
Mesh torusKnot(const TorusKnot& knot);

}  // namespace lambent::assets
