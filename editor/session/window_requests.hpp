// Holds what commands request from the window: a dialog, panels to bring to the front, or the end of the
// program. The window reads and clears them once a frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "editor/session/desktop_dialog.hpp"
#include "editor/session/dialog.hpp"

namespace lambent::editor {

struct WindowRequests {
  std::optional<Dialog> dialog;  // at most one at a time
  // The program for the desktop's own file dialogs. Empty: there is none, or a script drives the window.
  std::filesystem::path desktop_program;
  DesktopDialog desktop_dialog;
  std::vector<std::string> wanted_panels;  // names of panels to bring to the front
  bool raise_tabs = true;                  // also bring the preferences' tabs to the front
  // Ids of commands to run in the next frame, when fields that were open have taken over what was typed.
  std::vector<std::string> wanted_commands;
  bool palette = false;  // the list of commands is open
  bool keys = false;     // the list of keys is open
  std::string palette_words;
  bool quit = false;
  std::uint64_t frames = 0;  // how many the window has drawn
};

}  // namespace lambent::editor
