// Holds what commands ask of the window, whoever draws it: a dialog, panels that shall come up, the end of
// the program. These are values that the window reads and clears once a frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/session/dialog.hpp"

namespace lambent::editor {

struct WindowRequests {
  std::optional<Dialog> dialog;            // at most one
  std::vector<std::string> wanted_panels;  // names of panels to bring up
  bool raise_tabs = true;                  // the tabs that the preferences name are to come up
  bool quit = false;
};

}  // namespace lambent::editor
