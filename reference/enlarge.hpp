// A small picture in the place of a large one: bilinear between its pixels' centres, so that a coarse picture
// lies where the fine one will. Without depths: between two surfaces there is none.
#pragma once

#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::baker::reference {

spec::RgbaImage enlarged(const spec::RgbaImage& image, const spec::Size& size);

}  // namespace lambent::baker::reference
