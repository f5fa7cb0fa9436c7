#include "runtime/frame/quality.hpp"

#include <array>

#include <fmt/format.h>

namespace lambent::frame {

namespace {

constexpr std::array<std::string_view, 3> kNames = {"low", "default", "high"};

}  // namespace

std::span<const std::string_view> qualityNames() {
  return kNames;
}

Result<FrameSettings> settingsOfQuality(std::string_view name) {
  FrameSettings settings;
  if (name == "low") {
    settings.keys = 4;
    settings.key_size = 2048;
    settings.key_samples = 12;
  } else if (name == "high") {
    settings.keys = 32;
    settings.key_size = 8192;
    settings.key_samples = 64;
  } else if (name != "default") {
    return fail("--quality", fmt::format("\"{}\" is not known", name), "give low, default or high");
  }
  return settings;
}

}  // namespace lambent::frame
