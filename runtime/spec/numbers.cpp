#include "runtime/spec/numbers.hpp"

#include <charconv>
#include <cmath>

namespace lambent::spec {

std::optional<float> parseNumber(std::string_view text) {
  float value = 0.0f;
  const char* const end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);  // takes no spaces and ignores locales
  if (code != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::vector<float>> parseNumbers(std::string_view text) {
  std::vector<float> values;
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::optional<float> value = parseNumber(text.substr(0, comma));
    if (!value) return std::nullopt;
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace lambent::spec
