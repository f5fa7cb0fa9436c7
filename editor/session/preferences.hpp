// Loads and saves what the editor remembers between runs: layout and recent files. The file
// is $XDG_CONFIG_HOME/lambent/editor.json. If it is missing or damaged, defaults are used; errors while
// saving are ignored.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lambent::editor {

enum class Dock : std::uint8_t { Left, Right, Bottom };
inline constexpr std::array kDocks = {Dock::Left, Dock::Right, Dock::Bottom};
std::string_view dockWord(Dock dock);  // "left", "right", "below"

struct DockLayout {
  float share = 0.0f;  // of the window's width or height; 0: what its panels need
  std::string tab;     // name of the panel in front
  bool shown = true;
  bool operator==(const DockLayout&) const = default;
};

// Holds how the window is divided: the room and the front panel of each dock around the view.
struct WindowLayout {
  WindowLayout();  // the default layout

  std::array<DockLayout, 3> docks;  // in the order of Dock
  bool view_only = false;           // the view fills the window

  DockLayout& of(Dock dock) { return docks[static_cast<std::size_t>(dock)]; }
  const DockLayout& of(Dock dock) const { return docks[static_cast<std::size_t>(dock)]; }
  bool operator==(const WindowLayout&) const = default;
};

struct Preferences {
  int width = 1600, height = 950;  // of the window
  WindowLayout layout;
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
