// Computes the geometry of cube maps in OpenGL's layout. Faces are ordered +X, -X, +Y, -Y, +Z, -Z. Texel (x,
// y) of a face lies at s = (x + 0.5) / size, t = (y + 0.5) / size, with y in memory order. With sc = 2s - 1
// and tc = 2t - 1 the directions, before normalisation, are
//   +X (1, -tc, -sc)    -X (-1, -tc, sc)    +Y (sc, 1, tc)
//   -Y (sc, -1, -tc)    +Z (sc, -tc, 1)     -Z (-sc, -tc, -1).
// A map has 6 * size * size texels, face by face, row by row.
#pragma once

#include <glm/vec3.hpp>

namespace lambent::sh {

// Returns a direction whose largest component is 1 in magnitude. sc and tc are in [-1, 1].
glm::dvec3 cubeFaceDirection(int face, double sc, double tc);

// Returns the unit direction through the centre of a texel.
glm::dvec3 cubeTexelDirection(int size, int face, int x, int y);

// Returns the exact solid angle of a texel in steradians, which is the same on every face.
double cubeTexelSolidAngle(int size, int x, int y);

// Returns the exact solid angle (sr) of the rectangle [u0, u1] x [v0, v1] on the plane at distance 1.
double rectangleSolidAngle(double u0, double u1, double v0, double v1);

}  // namespace lambent::sh
