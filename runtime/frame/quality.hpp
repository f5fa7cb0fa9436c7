// Defines named sets of settings that trade accuracy of pictures for raster time: low for weak devices, high
// for the most accurate pictures. Settings that a set does not name stay as they are. docs/accuracy.md says
// what each costs and how it looks. Unknown names are returned as an Error.
#pragma once

#include <span>
#include <string_view>

#include "runtime/frame/frame_settings.hpp"

namespace lambent::frame {

// Returns the names that --quality takes: low, default, high.
std::span<const std::string_view> qualityNames();
// Returns the names of the rows of settingRows() that a quality sets.
std::span<const std::string_view> qualitySettings();

Result<void> putQuality(FrameSettings& settings, std::string_view name);
Result<FrameSettings> settingsOfQuality(std::string_view name);
// Returns the quality with these values of its settings, or an empty name if there is none.
std::string_view qualityOf(const FrameSettings& settings);

}  // namespace lambent::frame
