// Maps texels of an environment map to directions, and projects maps to light vectors. The layouts are
// lat-long (2:1), angular map (1:1) and vertical cross (3:4), drawn in docs/conventions.md. Texel (x, y) has
// column x from the left and row y from the top. Continuous image coordinates put the top left corner of the
// picture at (0, 0) and texel centres at half-integers. Texels that show no direction (outside the circle, in
// empty squares of the cross) have solid angle 0 and direction (0, 0, 0). Directions are unit vectors,
// right-handed, with +Y up.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

enum class ImageLayout { LatLong, AngularMap, VerticalCross };

// Returns "lat-long", "angular-map" or "vertical-cross".
std::string_view name(ImageLayout layout);

// Returns the layout that has this shape, or nothing if none has.
std::optional<ImageLayout> layoutOfShape(int width, int height);

// Returns the direction through the centre of a texel.
glm::dvec3 texelDirection(ImageLayout layout, int width, int height, int x, int y);

// Returns the solid angle of a texel in steradians. It is exact for lat-long and cross. For the angular map
// it is the density at the texel's centre times its area, which sums to 4pi up to about 3/N² for N texels of
// width.
double texelSolidAngle(ImageLayout layout, int width, int height, int x, int y);

// Returns the image coordinates of a direction of any length except zero.
glm::dvec2 imageCoordinates(ImageLayout layout, int width, int height, const glm::dvec3& dir);

// Computes the geometry of cube maps in OpenGL's layout. Faces are ordered +X, -X, +Y, -Y, +Z, -Z. Texel (x,
// y) of a face lies at s = (x + 0.5) / size, t = (y + 0.5) / size, with y in memory order. With sc = 2s - 1
// and tc = 2t - 1 the directions, before normalisation, are
//   +X (1, -tc, -sc)    -X (-1, -tc, sc)    +Y (sc, 1, tc)
//   -Y (sc, -1, -tc)    +Z (sc, -tc, 1)     -Z (-sc, -tc, -1).
// A map has 6 * size * size texels, face by face, row by row.

// Returns a direction whose largest component is 1 in magnitude. sc and tc are in [-1, 1].
glm::dvec3 cubeFaceDirection(int face, double sc, double tc);

// Returns the unit direction through the centre of a texel.
glm::dvec3 cubeTexelDirection(int size, int face, int x, int y);

// Returns the exact solid angle of a texel in steradians, which is the same on every face.
double cubeTexelSolidAngle(int size, int x, int y);

// Returns the exact solid angle (sr) of the rectangle [u0, u1] x [v0, v1] on the plane at distance 1.
double rectangleSolidAngle(double u0, double u1, double v0, double v1);

// Projects a picture to a light vector in double precision: c_i is the sum over texels of radiance
// y_i(direction) solid angle. `texels` has width * height entries, row by row. A texel with a NaN or infinite
// channel counts as black.
LightVector projectImage(int order, ImageLayout layout, int width, int height,
                         std::span<const glm::vec3> texels);

// Returns the weights of texels. The weight of texel k (in the order of image_layout.hpp) for coefficient i
// is entry i * 6 size² + k. It is Omega (2 y(centre) - mean of y over the texel), where Omega is the texel's
// solid angle. For box-filtered texels this cancels the leading error that y(centre) or the mean alone would
// have. A multiple of Omega is then subtracted from coefficients 1 and up, so that uniform light gives
// exactly constantLight.
std::vector<float> cubeWeights(int order, int size);

}  // namespace lambent::sh
