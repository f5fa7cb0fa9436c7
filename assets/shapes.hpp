// Makes the simple shapes of the scenes. Transfer per vertex needs vertices where shadows change, so every
// shape takes an edge length. Adjacent faces have equal vertices along their common edge, so boxes and
// spheres are closed.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::assets {

// Declares the triangle mesh of the scene generator: in metres, +Y up, counter-clockwise seen from outside.
// Only the generator uses it; the programs read the glTF files that it writes.
struct Mesh {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;    // unit length
  std::vector<glm::vec2> texcoords;  // empty or one per vertex
  std::vector<std::uint32_t> indices;
};

// Appends `more`, transformed by a matrix without shear. Both must have texture coordinates, or neither.
void append(Mesh& mesh, const Mesh& more, const glm::mat4& place = glm::mat4(1.0f));

Mesh withoutTexcoords(Mesh mesh);

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

// Makes a round tube around the (p, q) torus knot, which winds p times about the axis +Y and q times through
// the hole.
struct TorusKnot {
  int p = 2, q = 3;
  float ring_radius = 1.0f;   // of the torus that the knot winds on
  float torus_radius = 0.4f;  // of the tube of that torus
  float tube_radius = 0.15f;
  int cells_along = 300, cells_around = 24;
};

// Makes a closed mesh with analytic normals.
Mesh torusKnot(const TorusKnot& knot);

// Makes the Utah teapot from Martin Newell's 32 bicubic Bezier patches (1975, public domain), with the bottom
// that Frank Crow added. In Newell's data +Z is up, the spout points along +X, and the height is 3.15. Here
// +Y is up and the bottom is at 0. Body, lid, handle and spout intersect each other, and the surface is open
// there. Divides each patch into cells x cells. Normals are analytic, with their limits at poles.
Mesh teapot(int cells, float height_m);

// Computes value noise for the generator, with the same results on every machine.

// Hashes integers to [0, 1).
float hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed);
// Interpolates smoothly between lattice points and repeats after `period` lattice cells.
float noise(glm::vec2 at, std::uint32_t period, std::uint32_t seed);

}  // namespace lambent::assets
