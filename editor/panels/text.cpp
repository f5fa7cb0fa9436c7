#include "editor/panels/text.hpp"

#include <array>

#include <fmt/format.h>

namespace lambent::editor {

namespace {

std::string scaled(double value, double step, const std::array<const char*, 4>& units) {
  std::size_t unit = 0;
  while (value >= step && unit + 1 < units.size()) value /= step, ++unit;
  return fmt::format("{:.{}f}{}", value, unit == 0 || value >= 100.0 ? 0 : 1, units[unit]);
}

}  // namespace

std::string countText(double count) {
  return scaled(count, 1000.0, {"", " k", " M", " G"});
}
std::string bytesText(double bytes) {
  return scaled(bytes, 1024.0, {" B", " KiB", " MiB", " GiB"});
}
std::string timeText(double seconds) {
  if (seconds < 1.0) return fmt::format("{:.0f} ms", 1000.0 * seconds);
  if (seconds < 60.0) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<long>(seconds + 0.5);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace lambent::editor
