// Draws the contents of the window: panels in three docks around the view. One list names each panel and its
// draw function. Panels show the session and change it only through commands and the document's history. They
// need a Dear ImGui context; only the view also needs a window and OpenGL.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <imgui.h>

#include "editor/gizmo/projection.hpp"
#include "editor/session/field_numbers.hpp"
#include "editor/session/log.hpp"
#include "editor/session/scene_changes.hpp"
#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"
#include "runtime/frame/frame_settings.hpp"

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
void drawBakes(Session& session, Marks& marks);
void drawCost(Session& session, Marks& marks);
void drawLog(Session& session, Marks& marks);

// Draws the window's contents: panels in docks on each side and below, the view in the middle, and edges
// between them that can be dragged.
void drawLayout(Session& session, Renderer& renderer, Marks& marks);

// These are not in a dock: the menu bar, the view in the middle, and what is drawn above everything.
void drawMenus(Session& session, Marks& marks);
void drawViewport(Session& session, Renderer& renderer, Marks& marks);
void drawToolBar(Session& session, Marks& marks);    // above the view
void drawStartPage(Session& session, Marks& marks);  // in the view while the world is empty
void drawDialogs(Session& session, Marks& marks);
// Draws the items of a menu about what is selected, for rows of the tree and the view.
void drawSelectionMenu(Session& session, Marks& marks);

// ---- What several panels draw.

std::string countText(double count);   // "1.2 M"
std::string bytesText(double bytes);   // "3.4 MiB"
std::string timeText(double seconds);  // "850 ms", "12 s", "1:02"

inline const ImVec4 kErrorColor(0.95f, 0.42f, 0.36f, 1.0f);
inline const ImVec4 kWarningColor(0.95f, 0.75f, 0.35f, 1.0f);
inline const ImVec4 kNoteColor(0.82f, 0.82f, 0.82f, 1.0f);
inline const ImVec4 kGoodColor(0.5f, 0.8f, 0.5f, 1.0f);

ImVec4 severityColor(Severity severity);
ImVec4 standingColor(Standing standing);

// Labels are plain words. The exact names, by which scripts and files know fields, stand in tooltips.
// Returns a label for a component's field, or for a texture of a material: "Inner cone" for inner_cone.
std::string fieldLabel(std::string_view component, std::string_view field);
// Returns a sentence about the field where its label is not enough, or an empty text.
std::string_view fieldHelp(std::string_view component, std::string_view field);

struct NumberLook {
  double speed = 0.01;             // for a pixel of a drag
  double least = 0.0, most = 0.0;  // equal: no limits
  const char* format = "%.3f";     // of printf
  bool mixed = false;              // the selected ones differ: shows a dash
  bool scales = false;             // a drag multiplies, so that several keep their ratios
};

// Draw a number that is dragged or typed: Shift is finer, as for gizmos, Alt is coarser, and a click opens a
// text field. Return whether it changed.
bool dragNumber(const char* label, double& number, const NumberLook& look);
bool dragNumber(const char* label, float& number, const NumberLook& look);

// Tooltips of numbers end in this.
inline constexpr const char* kNumberHelp = "Drag; Shift: finer, Alt: coarser. Click to type";
// Stands for values that differ.
inline constexpr const char* kMixedText = "—";

// Draws a table of the fields that all entities use (session/field_numbers.hpp). Values that differ are shown
// as a dash. An edit reaches all entities: a drag shifts their numbers by the same amount, and those of
// lights' strength by the same factor; what is typed or chosen sets all alike. The last entity is the primary
// one.
void drawFields(Session& session, Marks& marks, const scene::ComponentInfo& component,
                std::span<const ecs::Entity> entities);

// Begins a table of labels, which take this share of the width, and values. It is ended by ImGui::EndTable().
// Returns whether it is shown.
bool beginFieldTable(const char* id, float labels = 0.38f);
// Begins a row: draws its label, and goes to its value.
void beginFieldRow(std::string_view label, std::string_view help);

// Makes one step of the history from a drag of the widget that was drawn last.
void asOneStep(Session& session, const char* name);
// Logs why an edit was refused, if it was.
void logRefusal(Session& session, const Result<void>& done);

}  // namespace lambent::editor
