#include "editor/app/layout.hpp"

#include <algorithm>
#include <utility>

#include <imgui.h>

#include "editor/app/docks.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

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

void drawLayout(Session& session, Renderer& renderer, Marks& marks) {
  drawMenus(session, marks);
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
  drawKeys(session, marks);
  drawPalette(session, marks);
  drawToasts(session, marks, {{left, top}, {left + middle, top + height - bottom}});
}

}  // namespace lambent::editor
