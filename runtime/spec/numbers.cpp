#include "runtime/spec/numbers.hpp"

#include <charconv>
#include <cmath>

namespace lambent::spec {

namespace {

template <typename Number>
std::optional<Number> parseOne(std::string_view text) {
  Number value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);  // takes no spaces and ignores locales
  if (code != std::errc{} || stop != end || !std::isfinite(static_cast<float>(value))) return std::nullopt;
  return value;
}

}  // namespace

std::optional<float> parseNumber(std::string_view text) {
  return parseOne<float>(text);
}

template <typename Number>
std::optional<std::vector<Number>> parseNumbers(std::string_view text) {
  std::vector<Number> values;
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::optional<Number> value = parseOne<Number>(text.substr(0, comma));
    if (!value) return std::nullopt;
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

template std::optional<std::vector<float>> parseNumbers(std::string_view text);
template std::optional<std::vector<double>> parseNumbers(std::string_view text);

}  // namespace lambent::spec
