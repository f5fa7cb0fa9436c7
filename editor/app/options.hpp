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
  bool json = false;          // --json: writes the script's answers to stdout
  bool remember = true;       // whether to load and save the layout and the recent files
  int width = 0, height = 0;  // in pixels; 0: as remembered
  float scale = 0.0f;         // of text and widgets; 0: as remembered
};

std::variant<Options, int> parseOptions(int argc, const char* const* argv);

void printError(const Error& error);

}  // namespace lambent::editor
