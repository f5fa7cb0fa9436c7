#include "editor/session/window_layout.hpp"

#include <algorithm>

namespace lambent::editor {

namespace {

constexpr std::array<std::string_view, 3> kWords = {"left", "right", "below"};  // in the order of Dock

}  // namespace

std::string_view dockWord(Dock dock) {
  return kWords[static_cast<std::size_t>(dock)];
}

std::optional<Dock> parseDock(std::string_view word) {
  for (const Dock dock : kDocks)
    if (dockWord(dock) == word) return dock;
  return std::nullopt;
}

WindowLayout::WindowLayout() {
  of(Dock::Left).tab = "Scene";
  of(Dock::Right).tab = "Inspector";
  of(Dock::Bottom).tab = "Bakes";
}

std::optional<WindowLayout> layoutNamed(std::string_view name) {
  WindowLayout layout;
  if (name == "default") return layout;
  if (name == "lighting") {
    layout.moved["Environment"] = Dock::Left;
    layout.of(Dock::Left).tab = "Environment";
    layout.of(Dock::Left).share = 0.24f;
    layout.of(Dock::Bottom).shown = false;
    return layout;
  }
  if (name == "baking") {
    layout.of(Dock::Right).tab = "Plan";
    layout.of(Dock::Bottom).share = 0.4f;
    return layout;
  }
  return std::nullopt;
}

}  // namespace lambent::editor
