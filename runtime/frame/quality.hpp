// Named sets of settings that trade accuracy of pictures for raster time: low for weak devices, high for the
// closest likeness. What a set does not name stays as it is. docs/accuracy.md says what each costs and shows.
// Errors: a name that is not known.
#pragma once

#include <span>
#include <string_view>

#include "runtime/frame/frame_settings.hpp"

namespace lambent::frame {

// Names, as --quality takes them: low, default, high.
std::span<const std::string_view> qualityNames();
// The rows of settingRows() that a quality sets.
std::span<const std::string_view> qualitySettings();

Result<void> putQuality(FrameSettings& settings, std::string_view name);
Result<FrameSettings> settingsOfQuality(std::string_view name);
// The quality that has these values of its settings; empty: none has.
std::string_view qualityOf(const FrameSettings& settings);

}  // namespace lambent::frame
