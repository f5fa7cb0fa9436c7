// Folds case where it does not count: in units, endings of file names and searches.
#pragma once

#include <string>
#include <string_view>

namespace lambent {

// Returns the text with small ASCII letters. Other bytes stay, so UTF-8 does too, whatever the locale is.
inline std::string lowerCase(std::string_view text) {
  std::string low(text);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return low;
}

}  // namespace lambent
