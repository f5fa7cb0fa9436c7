// Makes the simple shapes of the scenes. Transfer per vertex needs vertices where shadows change, so every
// shape takes an edge length. Adjacent faces have equal vertices along their common edge, so boxes and
// spheres are closed.
#pragma once

#include <functional>
#include <span>

#include "assets/mesh.hpp"

namespace lambent::assets {

// Makes a flat quad of cells_u x cells_v cells; its normal is edge_u x edge_v. Texture coordinates are in
// metres.
Mesh plane(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, int cells_u, int cells_v);

// Does the same with cells of about `cell` metres.
Mesh plane(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, float cell);

Mesh box(glm::vec3 low, glm::vec3 high, float cell);

// Projects a cube with cells x cells per face onto a sphere, so that there are no poles.
Mesh sphere(float radius, int cells);

// Turns a profile (radius, height) about +Y, from the bottom to the top, with the outside on its right. Every
// corner of the profile is a sharp edge, and its pieces are divided into lengths of about `cell`. The shape
// is closed if the profile starts and ends on the axis.
Mesh lathe(std::span<const glm::vec2> profile, int segments, float cell);

// Evaluates a function of (u, v) in [0, 1]² at every vertex of a grid; du x dv must point outside. The curved
// shapes use it.
struct SurfacePoint {
  glm::vec3 position, normal;
};
Mesh surface(int cells_u, int cells_v, const std::function<SurfacePoint(double u, double v)>& point);

}  // namespace lambent::assets
