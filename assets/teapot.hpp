// The Utah teapot from Martin Newell's 32 bicubic Bezier patches (1975, public domain), with the bottom that
// Frank Crow added. Newell's numbers: +Z is up there, the spout points along +X, the height is 3.15. Here +Y
// is up and the bottom stands at 0. Body, lid, handle and spout pass through each other; the surface is open
// where they do.
#pragma once

#include "assets/mesh.hpp"

namespace lambent::assets {

// Each patch cut into cells x cells; normals are those of the surface, at poles their limits.
Mesh teapot(int cells, float height_m);

}  // namespace lambent::assets
