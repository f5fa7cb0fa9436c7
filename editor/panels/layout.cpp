#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <imgui_internal.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

constexpr std::array kPanels = {
    Panel{"Scene", Dock::Left, "What is in the world: search, select, rename", &drawSceneTree},
    Panel{"Inspector", Dock::Right, "The components of what is selected", &drawInspector},
    Panel{"Environment", Dock::Right, "The light from outside: environment maps, sun, turn, exposure",
          &drawEnvironment},
    Panel{"Settings", Dock::Right, "How the picture is computed: bands, captures, effects", &drawSettings},
    Panel{"Bakes", Dock::Bottom, "What is being baked, how far, and what came of it", &drawBakes},
    Panel{"Cost", Dock::Bottom, "What ran in the last frame, how long it took, and why", &drawCost},
    Panel{"Log", Dock::Bottom, "Notices and errors", &drawLog},
};

struct Area {
  ImVec2 at, size;
};

// The flags of windows that the layout places.
constexpr ImGuiWindowFlags kFixedWindow =
    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

// Returns whether the dock is shown: it is switched on and has panels.
bool hasRoom(const WindowLayout& layout, Dock dock) {
  return layout.of(dock).shown && !layout.view_only &&
         std::ranges::any_of(panelList(), [&](const Panel& panel) { return panel.dock == dock; });
}

void drawDock(Session& session, Marks& marks, Dock dock, const Area& area) {
  WindowLayout& layout = session.preferences.layout;
  const std::string word(dockWord(dock));
  ImGui::SetNextWindowPos(area.at);
  ImGui::SetNextWindowSize(area.size);
  ImGui::Begin(word.c_str(), nullptr, kFixedWindow);
  marks.put("dock." + word, {{area.at.x, area.at.y}, {area.at.x + area.size.x, area.at.y + area.size.y}});
  if (ImGui::BeginTabBar("tabs", ImGuiTabBarFlags_FittingPolicyResizeDown)) {
    for (const Panel& panel : panelList()) {
      if (panel.dock != dock) continue;
      const bool raise = session.window.raise_tabs && layout.of(dock).tab == panel.name;
      const bool open = ImGui::BeginTabItem(panel.name, nullptr, raise ? ImGuiTabItemFlags_SetSelected : 0);
      marks.put(std::string("tab.") + panel.name);
      tooltip(std::string(panel.name) + ": " + panel.help);
      if (!open) continue;
      if (!session.window.raise_tabs) layout.of(dock).tab = panel.name;
      ImGui::BeginChild("panel");
      panel.draw(session, marks);
      ImGui::EndChild();
      ImGui::EndTabItem();
    }
    ImGui::EndTabBar();
  }
  ImGui::End();
}

// Draws an edge between two areas. Returns the place to which it is dragged, or 0 after a double click, which
// asks for the room that the panels need.
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

// Brings the panel to the front and shows its dock.
void raisePanel(Session& session, const std::string& name) {
  WindowLayout& layout = session.preferences.layout;
  for (const Panel& panel : panelList()) {
    if (name != panel.name) continue;
    DockLayout& dock = layout.of(panel.dock);
    dock.tab = name;
    dock.shown = true;
    layout.view_only = false;
    session.window.raise_tabs = true;
    session.viewing.changed = true;  // the tab opens in the next frame
    return;
  }
  session.log.warn("there is no panel \"" + name + "\"");
}

constexpr float kEdge = 5.0f;  // width in pixels of the edges between areas
// The dock below the view takes the left one's room, too, if the view is narrower than this many heights of
// the font.
constexpr float kWideEms = 36.0f;
// The view keeps this room in any case.
constexpr float kViewWidthEms = 10.0f, kViewHeightEms = 8.0f;

// How much room a dock has: at first a share of the window, but at least what its panels need in heights of
// the font and at most another share. The user can drag it further, but not below what shows a few words.
struct Room {
  float share, needed_ems, most_share, least_ems;
};
constexpr Room kLeft{0.17f, 13.0f, 0.28f, 8.0f}, kRight{0.24f, 22.0f, 0.44f, 12.0f},
    kBottom{0.24f, 10.0f, 0.4f, 4.0f};

float leastOf(const Room& room, float window) {
  return std::min(em(room.least_ems), room.most_share * window);
}

// Returns the room in pixels of a dock in a window of this size, of which others leave so much to it.
float roomOf(const DockLayout& dock, const Room& room, float window, float left_to_it) {
  const float at_first =
      std::min(std::max(room.share * window, em(room.needed_ems)), room.most_share * window);
  const float asked = dock.share > 0.0f ? dock.share * window : at_first;
  return std::max(std::min(asked, left_to_it), leastOf(room, window));
}

}  // namespace

std::span<const Panel> panelList() {
  return kPanels;
}

void drawLayout(Session& session, Renderer& renderer, Marks& marks) {
  drawMenus(session, marks);
  if (session.log.takeNewErrors()) session.window.wanted_panels.emplace_back("Log");
  for (const std::string& wanted : std::exchange(session.window.wanted_panels, {}))
    raisePanel(session, wanted);
  const float top = ImGui::GetFrameHeight();
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  WindowLayout& layout = session.preferences.layout;
  const float height = std::max(1.0f, screen.y - top);
  const bool has_left = hasRoom(layout, Dock::Left), has_right = hasRoom(layout, Dock::Right),
             has_bottom = hasRoom(layout, Dock::Bottom);
  const float view_width = em(kViewWidthEms), view_height = em(kViewHeightEms);
  const float kept = view_width + (has_left ? leastOf(kLeft, screen.x) : 0.0f);
  const float right = has_right ? roomOf(layout.of(Dock::Right), kRight, screen.x, screen.x - kept) : 0.0f;
  const float left =
      has_left ? roomOf(layout.of(Dock::Left), kLeft, screen.x, screen.x - right - view_width) : 0.0f;
  const float bottom =
      has_bottom ? roomOf(layout.of(Dock::Bottom), kBottom, height, height - view_height) : 0.0f;
  const float middle = std::max(1.0f, screen.x - left - right);
  const auto drag = [&](Dock dock, std::optional<float> to, float from, float whole) {
    if (!to) return;
    // Nothing: the room that the panels need.
    layout.of(dock).share = *to == 0.0f ? 0.0f : std::clamp(std::abs(*to - from) / whole, 0.01f, 1.0f);
  };

  ImGui::SetNextWindowPos(ImVec2(left, top));
  ImGui::SetNextWindowSize(ImVec2(middle, std::max(1.0f, height - bottom)));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
  ImGui::Begin("view", nullptr,
               kFixedWindow | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::PopStyleVar();
  if (!layout.view_only) drawToolBar(session, marks);
  drawViewport(session, renderer, marks);
  ImGui::End();

  const bool wide = has_bottom && middle < em(kWideEms);
  // Windows that are begun first lie above the others, so edges come before what they divide.
  const float bottom_at = top + height - bottom;
  const Area left_area{{0.0f, top}, {left, wide ? height - bottom : height}};
  const Area right_area{{screen.x - right, top}, {right, height}};
  const Area bottom_area{{wide ? 0.0f : left, bottom_at}, {wide ? left + middle : middle, bottom}};
  if (has_left)
    drag(Dock::Left, drawEdge(marks, "edge.left", {{left - kEdge, top}, {kEdge, left_area.size.y}}, true),
         0.0f, screen.x);
  if (has_right)
    drag(Dock::Right, drawEdge(marks, "edge.right", {right_area.at, {kEdge, height}}, true), screen.x,
         screen.x);
  if (has_bottom)
    drag(Dock::Bottom, drawEdge(marks, "edge.below", {bottom_area.at, {bottom_area.size.x, kEdge}}, false),
         screen.y, height);
  if (has_left) drawDock(session, marks, Dock::Left, left_area);
  if (has_right) drawDock(session, marks, Dock::Right, right_area);
  if (has_bottom) drawDock(session, marks, Dock::Bottom, bottom_area);
  session.window.raise_tabs = false;
  drawDialogs(session, marks);
}

}  // namespace lambent::editor
