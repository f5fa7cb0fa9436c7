// Searches texts as lists are filtered: by words, in any order and case.
#pragma once

#include <sstream>
#include <string>
#include <string_view>

#include "runtime/base/lower_case.hpp"

namespace lambent::editor {

// Returns whether all words of the search are parts of the text.
inline bool holdsWords(std::string_view text, std::string_view search) {
  const std::string low = lowerCase(text);
  std::istringstream words(lowerCase(search));
  for (std::string word; words >> word;)
    if (low.find(word) == std::string::npos) return false;
  return true;
}

}  // namespace lambent::editor
