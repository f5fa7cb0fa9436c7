// What the window is made of: panels in three docks around the view, each a row of one list with its name and
// the function that draws it. Panels show the session and change it through commands and the document's
// history, never on their own.
#pragma once

#include <span>

#include "editor/session/session.hpp"
#include "editor/ui/ui.hpp"

namespace lambent::editor {

enum class Dock : std::uint8_t { Left, Right, Bottom };

struct Panel {
  const char* name;
  Dock dock;
  const char* help;
  void (*draw)(Session& session, Ui& ui);
};

std::span<const Panel> panelList();

// Each in a file of its own.
void drawSceneTree(Session& session, Ui& ui);
void drawInspector(Session& session, Ui& ui);
void drawEnvironment(Session& session, Ui& ui);
void drawKeyLights(Session& session, Ui& ui);  // a part of the environment's
void drawSettings(Session& session, Ui& ui);
void drawPlan(Session& session, Ui& ui);
void drawBakes(Session& session, Ui& ui);
void drawBakeOptions(Session& session, Ui& ui, std::size_t scene);  // a part of the bakes'
void drawCost(Session& session, Ui& ui);
void drawAccuracy(Session& session, Ui& ui);
void drawStreaming(Session& session, Ui& ui);
void drawLog(Session& session, Ui& ui);

// Not in docks: the menu bar, the view in the middle, what comes up over all.
void drawMenus(Session& session, Ui& ui);
void drawViewport(Session& session, Ui& ui);
void drawToasts(Session& session, Ui& ui);
void drawDialogs(Session& session, Ui& ui);

}  // namespace lambent::editor
