// Formats counts and shares for sentences.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

namespace lambent::baker {

// Returns "1 draw", "3 draws".
inline std::string counted(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

// Returns a share as people write it: "100 %", "4.2 %", "0 %", and "<0.1 %" for what is less than the last
// decimal.
inline std::string percentText(double share, int decimals = 1) {
  const double percent = 100.0 * share, finest = std::pow(10.0, -decimals);
  if (percent > 0.0 && percent < finest) return fmt::format("<{:.{}f} %", finest, decimals);
  std::string text = fmt::format("{:.{}f}", percent, decimals);
  if (decimals > 0 && std::isfinite(percent)) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
  }
  return text + " %";
}

}  // namespace lambent::baker
