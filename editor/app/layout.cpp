#include "editor/app/layout.hpp"

#include <algorithm>
#include <utility>

#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

constexpr float kEdge = 5.0f;  // width in pixels of the edges between areas
constexpr float kLeastShare = 0.08f, kMostShare = 0.6f;
// Panels have at least this room in heights of the font, but at most this share of the window.
constexpr float kLeftEms = 13.0f, kRightEms = 22.0f, kBottomEms = 10.0f;
constexpr float kWideEms = 36.0f;
constexpr float kLeftShare = 0.28f, kRightShare = 0.44f, kBottomShare = 0.4f;
constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoTitleBar |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

struct Area {
  ImVec2 at, size;
};

void drawDock(const char* id, Dock dock, const Area& area, std::string& tab, Session& session, Marks& marks) {
  ImGui::SetNextWindowPos(area.at);
  ImGui::SetNextWindowSize(area.size);
  ImGui::Begin(id, nullptr, kFixed);
  if (ImGui::BeginTabBar("tabs", ImGuiTabBarFlags_FittingPolicyResizeDown)) {
    for (const Panel& panel : panelList()) {
      if (panel.dock != dock) continue;
      const bool raise = session.window.raise_tabs && tab == panel.name;
      const bool open = ImGui::BeginTabItem(panel.name, nullptr, raise ? ImGuiTabItemFlags_SetSelected : 0);
      marks.put(std::string("tab.") + panel.name);
      tooltip(std::string(panel.name) + ": " + panel.help);
      if (!open) continue;
      if (!session.window.raise_tabs) tab = panel.name;
      ImGui::BeginChild("panel");
      panel.draw(session, marks);
      ImGui::EndChild();
      ImGui::EndTabItem();
    }
    ImGui::EndTabBar();
  }
  ImGui::End();
}

// Draws an edge between two areas and returns by how many pixels it was dragged.
float drawEdge(const char* id, const Area& area, bool upright) {
  ImGui::SetNextWindowPos(area.at);
  ImGui::SetNextWindowSize(area.size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0f, 1.0f));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0f);
  ImGui::Begin(id, nullptr, kFixed | ImGuiWindowFlags_NoScrollbar);
  ImGui::InvisibleButton("edge", area.size);
  const bool active = ImGui::IsItemActive();
  if (active || ImGui::IsItemHovered())
    ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
  ImGui::End();
  ImGui::PopStyleVar(3);
  if (!active) return 0.0f;
  return upright ? ImGui::GetIO().MouseDelta.x : ImGui::GetIO().MouseDelta.y;
}

// Returns the room in pixels of panels that ask for so much.
float roomOf(float asked, float least_ems, float most) {
  return std::min(std::max(asked, em(least_ems)), most);
}

// Brings the panel to the front and shows its dock.
void raisePanel(Session& session, const std::string& wanted) {
  Preferences& p = session.preferences;
  for (const Panel& panel : panelList()) {
    if (wanted != panel.name) continue;
    (panel.dock == Dock::Left ? p.left_tab : panel.dock == Dock::Right ? p.right_tab : p.bottom_tab) = wanted;
    (panel.dock == Dock::Left    ? p.show_left
     : panel.dock == Dock::Right ? p.show_right
                                 : p.show_bottom) = true;
    session.window.raise_tabs = true;
    return;
  }
  session.log.warn("there is no panel \"" + wanted + "\"");
}

}  // namespace

void drawLayout(Session& session, Renderer& renderer, Marks& marks) {
  drawMenus(session, marks);
  for (const std::string& wanted : std::exchange(session.window.wanted_panels, {}))
    raisePanel(session, wanted);
  const float top = ImGui::GetFrameHeight();
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  Preferences& p = session.preferences;
  const float height = std::max(1.0f, screen.y - top);
  const float left = p.show_left ? roomOf(p.left * screen.x, kLeftEms, kLeftShare * screen.x) : 0.0f;
  const float right = p.show_right ? roomOf(p.right * screen.x, kRightEms, kRightShare * screen.x) : 0.0f;
  const float bottom = p.show_bottom ? roomOf(p.bottom * height, kBottomEms, kBottomShare * height) : 0.0f;
  const float middle = std::max(1.0f, screen.x - left - right);
  // An edge that was dragged starts from the room that the panel has, not from what it asked for.
  const auto drag = [](float& share, float room, float by, float whole) {
    if (by != 0.0f) share = std::clamp((room + by) / whole, kLeastShare, kMostShare);
  };

  ImGui::SetNextWindowPos(ImVec2(left, top));
  ImGui::SetNextWindowSize(ImVec2(middle, std::max(1.0f, height - bottom)));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
  ImGui::Begin("view", nullptr, kFixed | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::PopStyleVar();
  drawViewport(session, renderer, marks);
  ImGui::End();

  // Where the view is narrow, the tables below it take the left column's room too.
  const bool wide = p.show_bottom && middle < em(kWideEms);
  const float left_height = wide ? height - bottom : height;
  if (p.show_left) {
    drawDock("left", Dock::Left, {{0.0f, top}, {left, left_height}}, p.left_tab, session, marks);
    drag(p.left, left, drawEdge("left edge", {{left - kEdge, top}, {kEdge, left_height}}, true), screen.x);
  }
  if (p.show_right) {
    drawDock("right", Dock::Right, {{screen.x - right, top}, {right, height}}, p.right_tab, session, marks);
    drag(p.right, right, -drawEdge("right edge", {{screen.x - right, top}, {kEdge, height}}, true), screen.x);
  }
  if (p.show_bottom) {
    const float at = top + height - bottom;
    const Area area = wide ? Area{{0.0f, at}, {left + middle, bottom}} : Area{{left, at}, {middle, bottom}};
    drawDock("bottom", Dock::Bottom, area, p.bottom_tab, session, marks);
    drag(p.bottom, bottom, -drawEdge("bottom edge", {area.at, {area.size.x, kEdge}}, false), height);
  }
  session.window.raise_tabs = false;
  drawDialogs(session, marks);
  drawKeys(session, marks);
  drawPalette(session, marks);
  drawToasts(session, marks);
}

}  // namespace lambent::editor
