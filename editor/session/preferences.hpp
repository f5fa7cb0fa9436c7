// Loads and saves what the editor remembers between runs: layout, recent files, visible panels. The file is
// $XDG_CONFIG_HOME/lambent/editor.json. If it is missing or damaged, defaults are used; errors while saving
// are ignored.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lambent::editor {

struct Preferences {
  int width = 1600, height = 950;  // of the window
  // Fractions of the window that the side columns and the bottom row take.
  float left = 0.17f, right = 0.24f, bottom = 0.24f;
  std::string left_tab = "Scene", right_tab = "Inspector", bottom_tab = "Bakes";
  bool show_left = true, show_right = true, show_bottom = true;
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
