// Geometry of cube maps as OpenGL lays them out: faces +X, -X, +Y, -Y, +Z, -Z; texel (x, y) of a face lies at
// s = (x + 0.5) / size, t = (y + 0.5) / size, y counted in memory order. With sc = 2s - 1 and tc = 2t - 1 the
// direction is +X (1, -tc, -sc), -X (-1, -tc, sc), +Y (sc, 1, tc), -Y (sc, -1, -tc), +Z (sc, -tc, 1),
// -Z (-sc, -tc, -1), normalised. A whole map is 6 * size * size texels, face after face, row after row.
#pragma once

#include <glm/vec3.hpp>

namespace lambent::sh {

// Not normalised: the largest component is 1 in magnitude. sc, tc in [-1, 1].
glm::dvec3 cubeFaceDirection(int face, double sc, double tc);

// Unit direction through the centre of a texel.
glm::dvec3 cubeTexelDirection(int size, int face, int x, int y);

// Exact steradians of a texel; the same on every face.
double cubeTexelSolidAngle(int size, int x, int y);

// Exact steradians of the rectangle [u0, u1] x [v0, v1] on the plane at distance 1.
double rectangleSolidAngle(double u0, double u1, double v0, double v1);

}  // namespace lambent::sh
