#include "baker/pipeline/long_bake.hpp"

#include <cmath>

#include <fmt/format.h>

namespace lambent::baker {

std::optional<std::string> longBakeNotice(double processor_seconds) {
  if (processor_seconds <= kLongBake_s) return std::nullopt;
  const double minutes = processor_seconds / 60.0;
  const std::string time = minutes < 120.0 ? fmt::format("{:.0f} min", std::ceil(minutes))
                                           : fmt::format("{:.0f} hours", std::ceil(minutes / 60.0));
  return fmt::format(
      "takes about {} of processor time, less what the cache holds of it; fewer rays (--rays) take less, and "
      "lambent plan says it closer",
      time);
}

}  // namespace lambent::baker
