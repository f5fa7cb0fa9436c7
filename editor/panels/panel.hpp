// Draws the contents of the window: panels in three docks around the view. One list names each panel and its
// draw function. Panels show the session and change it only through commands and the document's history. They
// need a Dear ImGui context; only the view also needs a window and OpenGL.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "editor/gizmo/projection.hpp"
#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

class Renderer;

struct Panel {
  const char* name;
  Dock dock;
  const char* help;
  void (*draw)(Session& session, Marks& marks);
};

std::span<const Panel> panelList();

// Each is defined in a file of its own.
void drawSceneTree(Session& session, Marks& marks);
void drawInspector(Session& session, Marks& marks);
void drawEnvironment(Session& session, Marks& marks);
// Part of drawEnvironment and of the inspector of lights. Its widgets have marks that begin with `mark`.
void drawExposure(Session& session, Marks& marks, const std::string& mark);
void drawSettings(Session& session, Marks& marks);
void drawPlan(Session& session, Marks& marks);
void drawBakes(Session& session, Marks& marks);
void drawAssets(Session& session, Marks& marks);
void drawCost(Session& session, Marks& marks);
void drawAccuracy(Session& session, Marks& marks);
void drawStreaming(Session& session, Marks& marks);
void drawHistory(Session& session, Marks& marks);
void drawLog(Session& session, Marks& marks);

// Draws the window's contents: panels in docks on each side and below, the view in the middle, and edges
// between them that can be dragged.
void drawLayout(Session& session, Renderer& renderer, Marks& marks);

// These are not in a dock: the menu bar, the view in the middle, and what is drawn above everything.
void drawMenus(Session& session, Marks& marks);
void drawViewport(Session& session, Renderer& renderer, Marks& marks);
void drawToolBar(Session& session, Marks& marks);                        // above the view
void drawToasts(Session& session, Marks& marks, const Rectangle& view);  // in the view's lower right corner
void drawStartPage(Session& session, Marks& marks);  // in the view while the world is empty
void drawDialogs(Session& session, Marks& marks);
void drawKeys(Session& session, Marks& marks);
void drawPalette(Session& session, Marks& marks);
inline constexpr float kClickPixels = 4.0f;  // a press in the view that moves no further is a click
// Handles the pointer in the view, except for the camera: it picks entities, drags the handles of the
// selection and of lights, and drags suns over the sky. Every drag is one step of the history. Call it right
// after the view's own widget. Returns the pixel at which the user clicked to pick something, from the view's
// top left corner, or none if there was no such click.
std::optional<glm::vec2> manipulate(Session& session, Marks& marks, const Viewport& viewport, bool hovered);
// Draws the items of a menu about what is selected, for rows of the tree and the view.
void drawSelectionMenu(Session& session, Marks& marks);

}  // namespace lambent::editor
