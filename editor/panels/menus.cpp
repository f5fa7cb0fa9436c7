#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/session/scene_changes.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

// Returns the command's title; of undo and redo, what they would change.
std::string titleOf(const Session& session, const Command& command) {
  if (std::strcmp(command.id, "undo") == 0) return session.history.undoName();
  if (std::strcmp(command.id, "redo") == 0) return session.history.redoName();
  return command.title;
}

// Runs the command in the next frame. A field that is open is left first and takes over what was typed, so
// that undo takes this back and not the step before.
void runAfterFields(Session& session, const Command& command) {
  ImGui::ClearActiveID();
  session.window.wanted_commands.emplace_back(command.id);
}

// Draws a command as a menu item. Returns whether it was chosen.
bool drawCommandItem(const Session& session, Marks& marks, const Command& command, const char* mark) {
  const bool enabled = !command.enabled || command.enabled(session);
  const bool checked = command.checked && command.checked(session);
  const bool chosen = ImGui::MenuItem(titleOf(session, command).c_str(), command.shortcut, checked, enabled);
  marks.put(std::string(mark) + command.id);
  tooltip(command.help);
  return chosen;
}

bool isUndoOrRedo(const Command& command) {
  return std::strcmp(command.id, "undo") == 0 || std::strcmp(command.id, "redo") == 0;
}

// Runs shortcuts. While text is being typed, only undo and redo are any.
void runShortcuts(Session& session) {
  const ImGuiIO& io = ImGui::GetIO();
  // W, A, S and D fly the camera while the right button is held.
  if (ImGui::IsMouseDown(ImGuiMouseButton_Right) || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId))
    return;
  for (const Command& command : commandList()) {
    if (*command.shortcut == '\0' || (io.WantTextInput && !isUndoOrRedo(command))) continue;
    const auto keys = parseShortcut(command.shortcut);
    if (!keys || io.KeyCtrl != keys->ctrl || io.KeyShift != keys->shift || io.KeyAlt != keys->alt) continue;
    if (!keyPressed(keys->key, /*repeat=*/false)) continue;
    if (isUndoOrRedo(command) && ImGui::IsAnyItemActive()) {
      runAfterFields(session, command);
      continue;
    }
    if (command.enabled && !command.enabled(session)) continue;
    runOrLog(session, command.id, {});
  }
}

void drawRecentMenu(Session& session, Marks& marks) {
  const bool open = ImGui::BeginMenu("Recent", !session.preferences.recent.empty());
  marks.put("menu.recent");
  if (!open) return;
  for (const std::string& file : std::vector(session.preferences.recent)) {
    if (ImGui::MenuItem(file.c_str())) runOrLog(session, "open", std::array{file});
    marks.put("menu.recent." + std::filesystem::path(file).filename().string());
  }
  ImGui::EndMenu();
}

// Lists the panels in a menu of their own, because with them the Window menu would be longer than a small
// window.
void drawPanelItems(Session& session, Marks& marks) {
  ImGui::Separator();
  const bool open = ImGui::BeginMenu("Panels");
  marks.put("menu.panels");
  if (!open) return;
  for (const Panel& panel : panelList()) {
    if (ImGui::MenuItem(panel.name)) session.window.wanted_panels.emplace_back(panel.name);
    marks.put(std::string("menu.panel.") + panel.name);
  }
  ImGui::EndMenu();
}

// Draws at the right end what scenes lack, which a click explains in the Bakes panel, and the picture's time.
void drawStatusLine(Session& session, Marks& marks) {
  const SceneStatus scenes = worstStatus(session);
  const std::string picture = pictureStatus(session);
  const float gap = em(1.0f), picture_width = ImGui::CalcTextSize(picture.c_str()).x + gap;
  const float room = ImGui::GetWindowWidth() - ImGui::GetCursorPosX() - picture_width - gap;
  const std::string shown = ellipsized(scenes.text, std::max(0.0f, room));
  const float width = scenes.text.empty() ? 0.0f : ImGui::CalcTextSize(shown.c_str()).x + gap;
  ImGui::SameLine(std::max(ImGui::GetCursorPosX(), ImGui::GetWindowWidth() - width - picture_width));
  if (!scenes.text.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, standingColor(scenes.standing));
    ImGui::TextUnformatted(shown.c_str());
    ImGui::PopStyleColor();
    marks.put("status.scenes");
    if (ImGui::IsItemClicked()) session.window.wanted_panels.emplace_back("Bakes");
    tooltip(scenes.detail.empty() ? scenes.text : scenes.text + "\n" + scenes.detail);
    ImGui::SameLine(ImGui::GetWindowWidth() - picture_width);
  }
  ImGui::TextDisabled("%s", picture.c_str());
  marks.put("status");
}

}  // namespace

void drawMenus(Session& session, Marks& marks) {
  for (const std::string& id : std::exchange(session.window.wanted_commands, {})) runOrLog(session, id, {});
  runShortcuts(session);
  if (!ImGui::BeginMainMenuBar()) return;
  constexpr std::array kMenus = {"File", "Edit", "Create", "View", "Bake", "Window", "Help"};
  for (const char* menu : kMenus) {
    const bool open = ImGui::BeginMenu(menu);
    marks.put(std::string("menu.") + menu);
    if (!open) continue;
    for (const Command& command : commandList()) {
      if (std::strcmp(command.menu, menu) != 0) continue;
      if (*command.title == '-')
        ImGui::Separator();
      else if (*command.title != '\0' && drawCommandItem(session, marks, command, "menu."))
        runAfterFields(session, command);
      if (std::strcmp(command.id, "open") == 0) drawRecentMenu(session, marks);
    }
    if (std::strcmp(menu, "Window") == 0) drawPanelItems(session, marks);
    ImGui::EndMenu();
  }
  drawStatusLine(session, marks);
  ImGui::EndMainMenuBar();
}

namespace {

// An empty id is a separator.
constexpr std::array kItems = {"frame", "rename", "duplicate", "delete",    "",
                               "copy",  "paste",  "reset",     "",          "move",
                               "turn",  "scale",  "",          "frame-all", "select-none"};

constexpr std::array kCameraItems = {"look-through", "camera-to-view"};

void drawContextItem(Session& session, Marks& marks, const Command& command) {
  if (drawCommandItem(session, marks, command, "context.")) runOrLog(session, command.id, {});
}

}  // namespace

void drawSelectionMenu(Session& session, Marks& marks) {
  const Command* first = findCommand(kCameraItems.front());
  if (first && first->enabled(session)) {
    for (const char* id : kCameraItems) drawContextItem(session, marks, *findCommand(id));
    ImGui::Separator();
  }
  for (const char* id : kItems) {
    const Command* command = findCommand(id);
    if (command)
      drawContextItem(session, marks, *command);
    else
      ImGui::Separator();
  }
}

namespace {

constexpr float kStepEms = 4.0f;

float buttonWidth(const char* text) {
  return ImGui::CalcTextSize(text).x + 2.0f * ImGui::GetStyle().FramePadding.x;
}

// Draws a button that runs a command, lit while its switch is on.
void drawCommand(Session& session, Marks& marks, const char* id, const char* text,
                 std::string_view more = {}) {
  const Command* command = findCommand(id);
  const bool on = command->checked && command->checked(session);
  if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyle().Colors[ImGuiCol_ButtonActive]);
  if (ImGui::Button(text)) runOrLog(session, id, {});
  if (on) ImGui::PopStyleColor();
  marks.put(std::string("tool.") + id);
  tooltip(fmt::format("{} ({})\n{}{}", command->title, command->shortcut, command->help, more));
}

void drawStep(Marks& marks, const char* name, float& step, const char* format, double most) {
  ImGui::SetNextItemWidth(em(kStepEms));
  const std::string id = fmt::format("##{}", name);
  dragNumber(id.c_str(), step,
             {.speed = 0.005 * double{step}, .least = 0.001, .most = most, .format = format});
  marks.put(fmt::format("tool.snap.{}", name));
  tooltip(fmt::format("Step of a drag that snaps\n{}", kNumberHelp));
}

}  // namespace

void drawToolBar(Session& session, Marks& marks) {
  GizmoOptions& options = session.handles.gizmo.options;
  const ImGuiStyle& style = ImGui::GetStyle();
  ImGui::SetCursorPos(ImVec2(style.ItemSpacing.x, style.ItemSpacing.y));
  ImGui::BeginGroup();
  drawCommand(session, marks, "move", "Move");
  if (sameLineIfFits("Turn")) drawCommand(session, marks, "turn", "Turn");
  if (sameLineIfFits("Scale")) drawCommand(session, marks, "scale", "Scale");
  const char* axes = options.space == GizmoSpace::Local ? "Local" : "World";
  if (sameLineIfFits(em(1.0f) + buttonWidth(axes))) {
    ImGui::SameLine(0.0f, em(1.0f));
    drawCommand(session, marks, "local-axes", axes);
  }
  if (sameLineIfFits(em(1.0f) + buttonWidth("Snap"))) {
    ImGui::SameLine(0.0f, em(1.0f));
    drawCommand(session, marks, "snap", "Snap");
  }
  if (sameLineIfFits(em(kStepEms))) drawStep(marks, "metres", options.snap_m, "%.3g m", 1e3);
  if (sameLineIfFits(em(kStepEms))) drawStep(marks, "degrees", options.snap_deg, "%.3g°", 180.0);
  if (sameLineIfFits(em(kStepEms))) drawStep(marks, "factor", options.snap_scale, "× %.3g", 10.0);
  ImGui::EndGroup();
}

}  // namespace lambent::editor
