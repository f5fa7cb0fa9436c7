// This is the Utah teapot from Martin Newell's 32 bicubic Bezier patches (1975, public domain), with the
// bottom that Frank Crow added. In Newell's numbers +Z is up, the spout points along +X, and the height is
// 3.15. Here +Y is up and the bottom stands at 0. Body, lid, handle and spout pass through each other, and
// the surface is open there.
#pragma once

#include "assets/mesh.hpp"

namespace lambent::assets {

// Divides each patch into cells x cells; normals are those of the surface, with their limits at poles.
Mesh teapot(int cells, float height_m);

}  // namespace lambent::assets
