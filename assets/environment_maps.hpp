// Makes the environment maps that ship: a clear sky with a hazy sun, and a studio with three soft boxes. They
// are lat-long (row 0 is +Y, the image centre looks along +X). Both have a mean luminance of 1 over the
// sphere, so that pictures under either need about the same exposure. Nothing in them is narrower than 2
// degrees, so small images can represent them.
#pragma once

#include <cstdint>
#include <functional>

#include <glm/vec3.hpp>

#include "runtime/spec/image.hpp"

namespace lambent::assets {

spec::RgbImage skyMap(std::uint32_t width);
spec::RgbImage studioMap(std::uint32_t width);

// Makes an image of width x width / 2 texels, each the mean of samples x samples directions.
spec::RgbImage latLongImage(std::uint32_t width, int samples,
                            const std::function<glm::dvec3(glm::dvec3 dir)>& radiance);

// Returns the integral of the image over the sphere, by exact texel solid angles.
glm::dvec3 integrate(const spec::RgbImage& image);

// Scales the image to a mean luminance of 1.
void normalise(spec::RgbImage& image);

}  // namespace lambent::assets
