// Holds the text that was copied last: in the system's clipboard if a window has set its functions, else in
// `text`.
#pragma once

#include <functional>
#include <string>

namespace lambent::editor {

struct Clipboard {
  std::function<void(const std::string&)> put_system;
  std::function<std::string()> get_system;
  std::string text;

  void put(const std::string& value) {
    text = value;
    if (put_system) put_system(value);
  }
  std::string get() const { return get_system ? get_system() : text; }
};

}  // namespace lambent::editor
