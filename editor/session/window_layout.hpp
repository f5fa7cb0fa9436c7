// Holds how the window is divided: the room and the front panel of each dock around the view, and which
// panels the user moved to another dock. The editor keeps it between starts. Some layouts have names.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace lambent::editor {

enum class Dock : std::uint8_t { Left, Right, Bottom };
inline constexpr std::array kDocks = {Dock::Left, Dock::Right, Dock::Bottom};
std::string_view dockWord(Dock dock);  // "left", "right", "below"
std::optional<Dock> parseDock(std::string_view word);

struct DockLayout {
  float share = 0.0f;  // of the window's width or height; 0: what its panels need
  std::string tab;     // name of the panel in front
  bool shown = true;
  bool operator==(const DockLayout&) const = default;
};

struct WindowLayout {
  WindowLayout();  // the default layout

  std::array<DockLayout, 3> docks;    // in the order of Dock
  std::map<std::string, Dock> moved;  // panels that are elsewhere than at first
  bool view_only = false;             // the view fills the window

  DockLayout& of(Dock dock) { return docks[static_cast<std::size_t>(dock)]; }
  const DockLayout& of(Dock dock) const { return docks[static_cast<std::size_t>(dock)]; }
  bool operator==(const WindowLayout&) const = default;
};

// Returns one of the layouts that come with the program: "default", "lighting" (the environment beside the
// inspector of lamps) or "baking" (bakes and plan). Returns nothing if there is none of that name.
std::optional<WindowLayout> layoutNamed(std::string_view name);

}  // namespace lambent::editor
