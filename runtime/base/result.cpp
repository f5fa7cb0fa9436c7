#include "runtime/base/result.hpp"

#include <string_view>

namespace lambent {

namespace {

bool isControl(unsigned char c) {
  return c < 0x20 || c == 0x7f;
}

// Returns how many bytes the character of UTF-8 takes with which the text begins; 0 if it begins with none.
std::size_t characterLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = byte(0) < 0x80   ? 1
                             : byte(0) < 0xc2 ? 0
                             : byte(0) < 0xe0 ? 2
                             : byte(0) < 0xf0 ? 3
                             : byte(0) < 0xf5 ? 4
                                              : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0u) != 0x80u) return 0;
  return length;
}

// Returns the text without what a terminal would obey: colour codes of libraries, and control characters that
// a damaged file puts into its own names. What is no UTF-8 becomes a question mark. A long text is cut, since
// the rest would only hide what is wrong.
std::string shown(const std::string& text) {
  constexpr std::size_t kMost = 500;
  std::string out;
  for (std::size_t i = 0; i < text.size() && out.size() < kMost; ++i) {
    if (text[i] == '\x1b' && i + 1 < text.size() && text[i + 1] == '[') {
      for (i += 2; i < text.size() && !(text[i] >= '@' && text[i] <= '~');) ++i;
      continue;
    }
    const std::size_t length = characterLength(std::string_view(text).substr(i));
    if (length > 1) {
      out += text.substr(i, length);
      i += length - 1;
    } else {
      out += length == 0 ? '?' : isControl(static_cast<unsigned char>(text[i])) ? ' ' : text[i];
    }
  }
  return out.size() < kMost ? out : out + "...";
}

}  // namespace

std::string Error::line() const {
  std::string text = subject.empty() ? shown(problem) : shown(subject) + ": " + shown(problem);
  if (!hint.empty()) text += "; " + shown(hint);
  return text;
}

}  // namespace lambent
