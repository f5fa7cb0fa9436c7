// Named sets of settings that trade accuracy of pictures for raster time: low for weak devices, high for the
// closest likeness. What a set does not name stays as it is. docs/accuracy.md says what each costs and shows.
// Errors: a name that is not known.
#pragma once

#include <string_view>

#include "runtime/frame/frame_settings.hpp"

namespace lambent::frame {

// Names, as --quality takes them: low, default, high.
std::span<const std::string_view> qualityNames();

Result<FrameSettings> settingsOfQuality(std::string_view name);

}  // namespace lambent::frame
