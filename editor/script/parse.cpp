#include <fmt/format.h>

#include "editor/script/script.hpp"

namespace lambent::editor {

namespace {

// Returns the words of one line, or an error if a quote is not closed.
Result<std::vector<std::string>> wordsOf(const std::string& line, const std::string& place) {
  std::vector<std::string> words;
  std::string word;
  bool inside = false, quoted = false;
  const auto end = [&] {
    if (!word.empty() || quoted) words.push_back(word);
    word.clear();
    quoted = false;
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (inside && c == '\\' && i + 1 < line.size() && (line[i + 1] == '"' || line[i + 1] == '\\')) {
      word += line[++i];
    } else if (c == '"') {
      inside = !inside;
      quoted = true;
    } else if (!inside && c == '#' && word.empty()) {
      break;
    } else if (!inside && (c == ' ' || c == '\t' || c == '\r')) {
      end();
    } else {
      word += c;
    }
  }
  if (inside) return fail(place, "a quote is not closed", "end it with \"");
  end();
  return words;
}

}  // namespace

Result<std::vector<ScriptLine>> parseScript(const std::filesystem::path& name, const std::string& text) {
  std::vector<ScriptLine> lines;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    ++number;
    auto words = wordsOf(text.substr(begin, end - begin), fmt::format("{}:{}", name.string(), number));
    if (!words) return failAgain(words.error());
    begin = end + 1;
    if (words->empty()) continue;
    ScriptLine line{number, words->front() == "try", std::move(*words)};
    if (line.may_fail) line.words.erase(line.words.begin());
    if (!line.words.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace lambent::editor
