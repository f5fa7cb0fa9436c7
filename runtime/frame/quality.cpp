#include "runtime/frame/quality.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace lambent::frame {

namespace {

constexpr std::array<std::string_view, 3> kNames = {"low", "default", "high"};
constexpr std::array<std::string_view, 3> kSettings = {"keys", "key-size", "key-samples"};

}  // namespace

std::span<const std::string_view> qualityNames() {
  return kNames;
}

std::span<const std::string_view> qualitySettings() {
  return kSettings;
}

Result<void> putQuality(FrameSettings& settings, std::string_view name) {
  if (std::ranges::find(kNames, name) == kNames.end())
    return fail("quality", fmt::format("\"{}\" is not known", name), "give low, default or high");
  const FrameSettings defaults;
  settings.keys = defaults.keys;
  settings.key_size = defaults.key_size;
  settings.key_samples = defaults.key_samples;
  if (name == "low") {
    settings.keys = 4;
    settings.key_size = 2048;
    settings.key_samples = 12;
  } else if (name == "high") {
    settings.keys = 32;
    settings.key_size = 8192;
    settings.key_samples = 64;
  }
  return {};
}

Result<FrameSettings> settingsOfQuality(std::string_view name) {
  FrameSettings settings;
  if (Result<void> put = putQuality(settings, name); !put)
    return fail("--quality", put.error().problem, put.error().hint);
  return settings;
}

std::string_view qualityOf(const FrameSettings& settings) {
  for (const std::string_view name : kNames) {
    FrameSettings of_quality = settings;
    if (putQuality(of_quality, name) && of_quality == settings) return name;
  }
  return {};
}

}  // namespace lambent::frame
