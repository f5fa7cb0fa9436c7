#include "editor/app/docks.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui_internal.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

constexpr const char* kDragged = "panel";  // the type of what a dragged tab carries

void movePanel(Session& session, const std::string& panel, Dock dock) {
  runOrLog(session, "move-panel", std::array{panel, std::string(dockWord(dock))});
}

// Draws the menu of a tab and lets it be dragged.
void handleTab(Session& session, Marks& marks, const Panel& panel, Dock dock) {
  if (ImGui::BeginDragDropSource()) {
    ImGui::SetDragDropPayload(kDragged, panel.name, std::string_view(panel.name).size() + 1);
    ImGui::TextUnformatted(panel.name);
    ImGui::EndDragDropSource();
  }
  if (!ImGui::BeginPopupContextItem(panel.name)) return;
  for (const Dock to : kDocks) {
    if (ImGui::MenuItem(fmt::format("Move {}{}", to == Dock::Bottom ? "" : "to the ", dockWord(to)).c_str(),
                        nullptr, false, to != dock))
      movePanel(session, panel.name, to);
    marks.put(fmt::format("tab.{}.{}", panel.name, dockWord(to)));
  }
  ImGui::EndPopup();
}

// Takes a tab that is dropped anywhere onto the dock.
void takeTab(Session& session, Dock dock) {
  const ImGuiWindow* window = ImGui::GetCurrentWindow();
  if (!ImGui::BeginDragDropTargetCustom(window->Rect(), window->ID)) return;
  if (const ImGuiPayload* payload = ImGui::AcceptDragDropPayload(kDragged))
    movePanel(session, static_cast<const char*>(payload->Data), dock);
  ImGui::EndDragDropTarget();
}

}  // namespace

bool hasRoom(const WindowLayout& layout, Dock dock) {
  return layout.of(dock).shown && !layout.view_only &&
         std::ranges::any_of(panelList(), [&](const Panel& panel) { return dockOf(layout, panel) == dock; });
}

void drawDock(Session& session, Marks& marks, Dock dock, const Area& area) {
  // A panel that is moved while they are drawn counts from the next frame on.
  const WindowLayout layout = session.preferences.layout;
  const std::string word(dockWord(dock));
  ImGui::SetNextWindowPos(area.at);
  ImGui::SetNextWindowSize(area.size);
  ImGui::Begin(word.c_str(), nullptr, kFixedWindow);
  marks.put("dock." + word, {{area.at.x, area.at.y}, {area.at.x + area.size.x, area.at.y + area.size.y}});
  if (ImGui::BeginTabBar("tabs", ImGuiTabBarFlags_FittingPolicyResizeDown)) {
    for (const Panel& panel : panelList()) {
      if (dockOf(layout, panel) != dock) continue;
      const bool raise = session.window.raise_tabs && layout.of(dock).tab == panel.name;
      const bool open = ImGui::BeginTabItem(panel.name, nullptr, raise ? ImGuiTabItemFlags_SetSelected : 0);
      marks.put(std::string("tab.") + panel.name);
      tooltip(std::string(panel.name) + ": " + panel.help);
      handleTab(session, marks, panel, dock);
      if (!open) continue;
      if (!session.window.raise_tabs) session.preferences.layout.of(dock).tab = panel.name;
      ImGui::BeginChild("panel");
      panel.draw(session, marks);
      ImGui::EndChild();
      ImGui::EndTabItem();
    }
    ImGui::EndTabBar();
  }
  takeTab(session, dock);
  ImGui::End();
}

std::optional<float> drawEdge(Marks& marks, const char* name, const Area& area, bool upright) {
  ImGui::SetNextWindowPos(area.at);
  ImGui::SetNextWindowSize(area.size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0f, 1.0f));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0f);
  ImGui::Begin(name, nullptr, kFixedWindow | ImGuiWindowFlags_NoScrollbar);
  ImGui::InvisibleButton("edge", area.size);
  marks.put(name);
  const bool active = ImGui::IsItemActive();
  const bool again = ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  if (active || ImGui::IsItemHovered()) {
    ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
    ImGui::GetWindowDrawList()->AddRectFilled(
        ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
        ImGui::GetColorU32(active ? ImGuiCol_SliderGrabActive : ImGuiCol_SliderGrab));
  }
  ImGui::End();
  ImGui::PopStyleVar(3);
  if (again) return 0.0f;
  const ImGuiIO& io = ImGui::GetIO();
  if (!active || io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] == 0.0f) return std::nullopt;
  return std::max(1.0f, upright ? io.MousePos.x : io.MousePos.y);
}

void raisePanel(Session& session, const std::string& name) {
  WindowLayout& layout = session.preferences.layout;
  for (const Panel& panel : panelList()) {
    if (name != panel.name) continue;
    DockLayout& dock = layout.of(dockOf(layout, panel));
    dock.tab = name;
    dock.shown = true;
    layout.view_only = false;
    session.window.raise_tabs = true;
    return;
  }
  layout.moved.erase(name);
  session.log.warn("there is no panel \"" + name + "\"");
}

}  // namespace lambent::editor
