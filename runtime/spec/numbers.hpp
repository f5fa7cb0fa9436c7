// Parses numbers of the command line strictly: they are finite, decimal and separated by commas, without any
// other characters.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace lambent::spec {

// Parses one number. Returns nothing if there is any other character or the value is not finite.
std::optional<float> parseNumber(std::string_view text);

// Parses "A,B,C" as floats or, within their range, as doubles. Returns nothing if any part is not a number.
template <typename Number = float>
std::optional<std::vector<Number>> parseNumbers(std::string_view text);

}  // namespace lambent::spec
