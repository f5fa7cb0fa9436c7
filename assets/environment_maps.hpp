// Makes the environment maps that ship: a clear sky with a hazy sun, and a studio with three soft boxes. They
// are lat-long (row 0 is +Y, the image centre looks along +X). Both have a mean luminance of 1 over the
// sphere, so that pictures under either need about the same exposure. Nothing in them is narrower than 2
// degrees, so small images can represent them.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "runtime/spec/image.hpp"

namespace lambent::assets {

spec::RgbImage skyMap(std::uint32_t width);
spec::RgbImage studioMap(std::uint32_t width);

// Returns the integral of the image over the sphere, by exact texel solid angles.
glm::dvec3 integrate(const spec::RgbImage& image);

}  // namespace lambent::assets
