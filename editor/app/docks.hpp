// Draws the docks around the view, and the edges between them, which can be dragged. A tab's menu moves its
// panel to another dock, as dragging the tab there does.
#pragma once

#include <optional>

#include <imgui.h>

#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

struct Area {
  ImVec2 at, size;
};

// The flags of windows that the layout places.
inline constexpr ImGuiWindowFlags kFixedWindow =
    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

// Returns whether the dock is shown: it is switched on and has panels.
bool hasRoom(const WindowLayout& layout, Dock dock);
void drawDock(Session& session, Marks& marks, Dock dock, const Area& area);
// Draws an edge between two areas. Returns the place to which it is dragged, or 0 after a double click, which
// asks for the room that the panels need.
std::optional<float> drawEdge(Marks& marks, const char* name, const Area& area, bool upright);
// Brings the panel to the front and shows its dock.
void raisePanel(Session& session, const std::string& name);

}  // namespace lambent::editor
