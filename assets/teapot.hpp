// Makes the Utah teapot from Martin Newell's 32 bicubic Bezier patches (1975, public domain), with the bottom
// that Frank Crow added. In Newell's data +Z is up, the spout points along +X, and the height is 3.15. Here
// +Y is up and the bottom is at 0. Body, lid, handle and spout intersect each other, and the surface is open
// there.
#pragma once

#include "assets/shapes.hpp"

namespace lambent::assets {

// Divides each patch into cells x cells. Normals are analytic, with their limits at poles.
Mesh teapot(int cells, float height_m);

}  // namespace lambent::assets
