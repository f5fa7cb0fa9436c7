// Draws what the window is made of: panels in three docks around the view, each a row of one list with its
// name and the function that draws it. Panels show the session and change it through commands and the
// document's history, never on their own. They need a Dear ImGui context, and but for the view neither window
// nor OpenGL.
#pragma once

#include <span>

#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

class Renderer;

enum class Dock : std::uint8_t { Left, Right, Bottom };

struct Panel {
  const char* name;
  Dock dock;
  const char* help;
  void (*draw)(Session& session, Marks& marks);
};

std::span<const Panel> panelList();

// Each in a file of its own.
void drawSceneTree(Session& session, Marks& marks);
void drawInspector(Session& session, Marks& marks);
void drawEnvironment(Session& session, Marks& marks);
void drawKeyLights(Session& session, Marks& marks);  // a part of the environment's
void drawSettings(Session& session, Marks& marks);
void drawPlan(Session& session, Marks& marks);
void drawBakes(Session& session, Marks& marks);
void drawBakeOptions(Session& session, Marks& marks, std::size_t scene);  // a part of the bakes'
void drawCost(Session& session, Marks& marks);
void drawAccuracy(Session& session, Marks& marks);
void drawStreaming(Session& session, Marks& marks);
void drawLog(Session& session, Marks& marks);

// These stand in no dock: the menu bar, the view in the middle, and what comes up over all.
void drawMenus(Session& session, Marks& marks);
void drawViewport(Session& session, Renderer& renderer, Marks& marks);
void drawToasts(Session& session, Marks& marks);
void drawDialogs(Session& session, Marks& marks);

}  // namespace lambent::editor
