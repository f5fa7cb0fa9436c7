// Strict number parsing for the words of the command line: comma-separated decimal numbers, finite, nothing
// before, between or after them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace lambent::spec {

// One number; nothing if there is any other character, or if the value is not finite.
std::optional<float> parseNumber(std::string_view text);

// "A,B,C"; nothing if any part is not a number.
std::optional<std::vector<float>> parseNumbers(std::string_view text);

}  // namespace lambent::spec
