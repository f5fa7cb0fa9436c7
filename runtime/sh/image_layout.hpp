// Maps texels of an environment map to directions. The layouts are lat-long (2:1), angular map (1:1) and
// vertical cross (3:4), drawn in docs/conventions.md. Texel (x, y) has column x from the left and row y from
// the top. Continuous image coordinates put the top left corner of the picture at (0, 0) and texel centres at
// half-integers. Texels that show no direction (outside the circle, in empty squares of the cross) have solid
// angle 0 and direction (0, 0, 0). Directions are unit vectors, right-handed, with +Y up.
#pragma once

#include <optional>
#include <string_view>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

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

}  // namespace lambent::sh
