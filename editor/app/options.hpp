// Reads the command line of lambent-editor. Returns Options, or the exit code with which to stop: 0 after
// --help and --version, 2 after one line on stderr that says what is wrong and what to do.
#pragma once

#include <filesystem>
#include <optional>
#include <variant>

#include "editor/session/session.hpp"

namespace lambent::editor {

struct Options {
  SessionOptions session;
  std::optional<std::filesystem::path> script;
  bool json = false;          // the script's answers on stdout
  bool remember = true;       // layout and recent files
  int width = 0, height = 0;  // 0: as it was
  float scale = 0.0f;         // 0: as it was
};

std::variant<Options, int> parseOptions(int argc, const char* const* argv);

void printError(const Error& error);

}  // namespace lambent::editor
