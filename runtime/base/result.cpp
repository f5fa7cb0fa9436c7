#include "runtime/base/result.hpp"

namespace lambent {

std::string Error::line() const {
  std::string text = subject.empty() ? problem : subject + ": " + problem;
  if (!hint.empty()) text += "; " + hint;
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

}  // namespace lambent
