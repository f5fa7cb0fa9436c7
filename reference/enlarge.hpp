// Enlarges a small picture by bilinear interpolation between pixel centres, for previews. The result has no
// depths, because they cannot be interpolated across edges.
#pragma once

#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::baker::reference {

spec::RgbaImage enlarged(const spec::RgbaImage& image, const spec::Size& size);

}  // namespace lambent::baker::reference
