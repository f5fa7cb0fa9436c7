// Formats a count with its noun for sentences: "1 draw", "3 draws".
#pragma once

#include <cstddef>
#include <string>

#include <fmt/format.h>

namespace lambent::baker {

inline std::string counted(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace lambent::baker
