#include "runtime/base/result.hpp"

namespace lambent {

namespace {

bool isControl(unsigned char c) {
  return c < 0x20 || c == 0x7f;
}

// Returns the text without what a terminal would obey: colour codes of libraries, and control characters that
// a damaged file puts into its own names. A long text is cut, since the rest would only hide what is wrong.
std::string shown(const std::string& text) {
  constexpr std::size_t kMost = 500;
  std::string out;
  for (std::size_t i = 0; i < text.size() && out.size() < kMost; ++i) {
    if (text[i] == '\x1b' && i + 1 < text.size() && text[i + 1] == '[') {
      for (i += 2; i < text.size() && !(text[i] >= '@' && text[i] <= '~');) ++i;
      continue;
    }
    out += isControl(static_cast<unsigned char>(text[i])) ? ' ' : text[i];
  }
  if (out.size() < kMost) return out;
  while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xc0u) == 0x80u) out.pop_back();
  if (!out.empty()) out.pop_back();  // perhaps the first byte of a character that was cut
  return out + "...";
}

}  // namespace

std::string Error::line() const {
  std::string text = subject.empty() ? shown(problem) : shown(subject) + ": " + shown(problem);
  if (!hint.empty()) text += "; " + shown(hint);
  return text;
}

}  // namespace lambent
