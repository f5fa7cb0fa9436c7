// Enlarges a small picture, bilinearly between its pixels' centres, so that a coarse picture lies where the
// fine one will. The result has no depths, since there are none between two surfaces.
#pragma once

#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::baker::reference {

spec::RgbaImage enlarged(const spec::RgbaImage& image, const spec::Size& size);

}  // namespace lambent::baker::reference
