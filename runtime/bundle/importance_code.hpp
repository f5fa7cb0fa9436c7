// One byte a sample says how much a surface matters to pictures per area, relative to the mean over its
// group, in steps of half an octave: wide enough for all that a bake weighs by, and small once compressed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lambent::bundle {

inline constexpr int kMeanImportanceCode = 64;

// `relative` is 1 at the mean; 0 says that nobody sees anything of it, and has the code 0.
inline std::uint8_t importanceCode(float relative) {
  if (!(relative > 0.0f)) return 0;
  const float code = static_cast<float>(kMeanImportanceCode) + 2.0f * std::log2(relative);
  return static_cast<std::uint8_t>(std::clamp(std::round(code), 1.0f, 127.0f));
}

// Returns log2 of what a code other than 0 stands for.
constexpr float importanceOctaves(std::uint8_t code) {
  return 0.5f * static_cast<float>(code - kMeanImportanceCode);
}

}  // namespace lambent::bundle
