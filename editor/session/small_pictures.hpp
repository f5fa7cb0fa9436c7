// Makes the small pictures by which assets are recognised. Any thread.
#pragma once

#include "runtime/spec/image.hpp"

namespace lambent::editor {

// Exposes the environment map so that its median becomes middle grey.
spec::Rgba8Image smallPictureOf(const spec::RgbImage& environment_map);
// Averages the middle of a picture, which is cut to the shape of the small one. Alpha becomes 1.
spec::Rgba8Image smallPictureOf(const spec::Rgba8Image& view);
inline constexpr double kSmallPictureShape = 16.0 / 9.0;  // width / height of pictures of views

}  // namespace lambent::editor
