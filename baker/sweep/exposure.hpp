// Chooses how bright pictures are shown: one exposure for all pictures of a sweep, by the reference, so that
// neither an eye nor the perceptual metric sees another brightness as an error, or misses one.
#pragma once

#include "runtime/spec/image.hpp"

namespace lambent::baker {

// Returns the factor that brings the mean luminance of what the picture covers to a third of white.
float exposureOf(const spec::RgbaImage& reference);

// Returns the picture as a screen shows it with this factor.
spec::Rgba8Image shownWith(const spec::RgbaImage& picture, float exposure);

// Returns the mean of two pictures of one size.
spec::RgbaImage meanOf(const spec::RgbaImage& a, const spec::RgbaImage& b);

}  // namespace lambent::baker
