// Pictures of many looks a pixel. A picture and a reference that both look through the middles of pixels show
// different things where a middle lies on an edge; and errors that no eye can tell apart count in full. The
// mean of n x n pixels is what a screen of as many samples a pixel shows.
#pragma once

#include <string>

#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

// Every pixel the mean of n x n, coverage too; without depths, of which there is no mean. n = 1: as it is,
// with depths. Errors name `subject`: n less than 1, or a size that is no multiple of n.
Result<spec::RgbaImage> shrunk(const spec::RgbaImage& picture, std::uint32_t n, const std::string& subject);

}  // namespace lambent::baker
