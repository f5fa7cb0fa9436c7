// How a picture covers the sphere of directions: lat-long (2:1), angular map (1:1) and vertical cross (3:4),
// as docs/conventions.md draws them. Texel (x, y) has column x from the left and row y from the top;
// continuous image coordinates put the picture's top left corner at (0, 0) and texel centres at
// half-integers. Texels that show no direction (outside the circle, empty squares of the cross) have solid
// angle 0 and direction (0, 0, 0). Directions: unit, right-handed, +Y up.
#pragma once

#include <optional>
#include <string_view>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::sh {

enum class ImageLayout { LatLong, AngularMap, VerticalCross };

// "lat-long", "angular-map", "vertical-cross".
std::string_view name(ImageLayout layout);

// The layout that a picture of this shape must have; none for any other shape.
std::optional<ImageLayout> layoutOfShape(int width, int height);

// Direction through the centre of a texel.
glm::dvec3 texelDirection(ImageLayout layout, int width, int height, int x, int y);

// Steradians that a texel covers: exact for lat-long and cross; for the angular map the density at the
// texel's centre times its area (the sum over a picture N texels wide is 4pi to about 3/N²).
double texelSolidAngle(ImageLayout layout, int width, int height, int x, int y);

// Where a direction (any length but zero) lies in the picture.
glm::dvec2 imageCoordinates(ImageLayout layout, int width, int height, const glm::dvec3& dir);

}  // namespace lambent::sh
