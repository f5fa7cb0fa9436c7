// Averages pictures with many samples per pixel. If a picture and a reference both sample only the centres of
// pixels, they differ wherever a centre lies on an edge, and errors that no eye can see count in full. The
// mean of n x n pixels is what a screen with as many samples per pixel shows.
#pragma once

#include <string>

#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

// Makes every pixel the mean of n x n, coverage too. Depths are dropped, since they have no mean; n = 1
// returns the picture as it is, with depths. Errors name `subject`: n is less than 1, or the size is no
// multiple of n.
Result<spec::RgbaImage> shrunk(const spec::RgbaImage& picture, std::uint32_t n, const std::string& subject);

}  // namespace lambent::baker
