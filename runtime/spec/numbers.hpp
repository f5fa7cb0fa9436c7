// Parses numbers of the command line strictly: they are finite, decimal and separated by commas, without any
// other characters.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace lambent::spec {

// Parses one number, as a float or, within its range, as a double. Returns nothing if there is any other
// character or the value is not finite.
template <typename Number = float>
std::optional<Number> parseNumber(std::string_view text) {
  Number value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);  // takes no spaces and ignores locales
  if (code != std::errc{} || stop != end || !std::isfinite(static_cast<float>(value))) return std::nullopt;
  return value;
}

// Parses "A,B,C". Returns nothing if any part is not a number.
template <typename Number = float>
std::optional<std::vector<Number>> parseNumbers(std::string_view text) {
  std::vector<Number> values;
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::optional<Number> value = parseNumber<Number>(text.substr(0, comma));
    if (!value) return std::nullopt;
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace lambent::spec
