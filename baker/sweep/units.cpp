#include "baker/sweep/units.hpp"

#include <cmath>

#include <fmt/format.h>

namespace lambent::baker {

namespace {

// Keeps three figures, and no zeros behind the point.
std::string figures(double value) {
  if (value >= 100.0) return fmt::format("{:.0f}", value);
  return fmt::format("{:.3g}", value);
}

}  // namespace

std::string percent(double share) {
  const double value = 100.0 * share;
  return fmt::format("{:.{}f} %", value, value < 0.995 ? 2 : value < 99.5 ? 1 : 0);
}

std::string tickPercent(double share) {
  return fmt::format("{:g} %", std::round(1e6 * share) / 1e4);
}

std::string seconds(double value) {
  if (value < 1.0) return figures(1000.0 * value) + " ms";
  if (value < 120.0) return figures(value) + " s";
  return value < 7200.0 ? figures(value / 60.0) + " min" : figures(value / 3600.0) + " h";
}

std::string milliseconds(double value) {
  return seconds(0.001 * value);
}

std::string bytes(double value) {
  if (value < 1e3) return figures(value) + " B";
  if (value < 1e6) return figures(value / 1e3) + " kB";
  return value < 1e9 ? figures(value / 1e6) + " MB" : figures(value / 1e9) + " GB";
}

}  // namespace lambent::baker
