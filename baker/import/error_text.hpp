// Advice that several errors of this room give.
#pragma once

#include <exception>
#include <new>
#include <string>

namespace lambent::baker {

// For files that break the rules of glTF.
inline constexpr const char* kExportAgain = "export the scene again";

// Says in the words of a user what an exception of a library says.

// Returns the exception's text without the tag that nlohmann::json puts in front.
inline std::string reasonOf(const std::exception& exception) {
  if (dynamic_cast<const std::bad_alloc*>(&exception)) return "it needs more memory than there is";
  const std::string text = exception.what();
  const std::size_t tag = text.starts_with("[json.") ? text.find("] ") : std::string::npos;
  return tag == std::string::npos ? text : text.substr(tag + 2);
}

}  // namespace lambent::baker
