// Makes a picture for a screen out of linear light.
#pragma once

#include "runtime/spec/image.hpp"

namespace lambent::spec {

// Returns what lambent-demo shows at --exposure 0: the same tone curve (runtime/tone_map/tone_curve.glsl),
// then sRGB. The picture is opaque.
Rgba8Image displayed(const RgbaImage& linear);

}  // namespace lambent::spec
