// Loads and saves what the editor remembers between runs: layout, recent files, how handles drag. The file is
// $XDG_CONFIG_HOME/lambent/editor.json. If it is missing or damaged, defaults are used; errors while saving
// are ignored.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "editor/gizmo/gizmo.hpp"
#include "editor/session/window_layout.hpp"

namespace lambent::editor {

struct Preferences {
  int width = 1600, height = 950;  // of the window
  WindowLayout layout;
  std::map<std::string, WindowLayout> layouts;  // those that the user saved, by name
  GizmoOptions handles;                         // as the view had them at the end of the last run
  bool camera_preview = true;                   // an inset shows what a selected camera sees
  bool desktop_dialogs = true;    // files are chosen in the desktop's own dialogs where there are any
  float scale = 1.0f;             // of text and widgets
  std::string light_unit = "cd";  // in which lights are given that can be given in it
  std::vector<std::string> recent;

  void addRecent(const std::filesystem::path& file);
};

// Returns the file's path. It is empty if neither XDG_CONFIG_HOME nor HOME is set; then nothing is
// remembered.
std::filesystem::path preferencesFile();
Preferences loadPreferences(const std::filesystem::path& file);
void savePreferences(const std::filesystem::path& file, const Preferences& preferences);

}  // namespace lambent::editor
