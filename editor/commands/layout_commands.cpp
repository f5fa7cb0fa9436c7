// Implements the commands for the parts of the window: which docks there are, and which panels they hold.
#include <array>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

namespace {

Answer useLayout(Session& session, Words words) {
  const auto layout = layoutNamed(words[0]);
  if (!layout) return fail("layout", "\"" + words[0] + "\" is not known", "give default, lighting or baking");
  session.preferences.layout = *layout;
  session.window.raise_tabs = true;
  return nullptr;
}

constexpr std::array kLayouts = {"default", "lighting", "baking"};
template <std::size_t Index>
Answer named(Session& session, Words) {
  const std::array word = {std::string(kLayouts[Index])};
  return useLayout(session, word);
}

Answer viewOnly(Session& session, Words) {
  session.preferences.layout.view_only = !session.preferences.layout.view_only;
  return nullptr;
}
bool isViewOnly(const Session& session) {
  return session.preferences.layout.view_only;
}

// Shows or hides a dock. Where only the view is shown, all come back.
template <Dock Which>
Answer dock(Session& session, Words) {
  WindowLayout& layout = session.preferences.layout;
  bool& shown = layout.of(Which).shown;
  shown = layout.view_only || !shown;
  layout.view_only = false;
  return nullptr;
}
template <Dock Which>
bool docked(const Session& session) {
  const WindowLayout& layout = session.preferences.layout;
  return layout.of(Which).shown && !layout.view_only;
}

Answer panel(Session& session, Words words) {
  session.window.wanted_panels.push_back(words[0]);
  return nullptr;
}

Answer movePanel(Session& session, Words words) {
  const auto to = parseDock(words[1]);
  if (!to) return fail("move-panel", "\"" + words[1] + "\" is no place", "give left, right or below");
  session.preferences.layout.moved[words[0]] = *to;
  session.window.wanted_panels.push_back(words[0]);
  return nullptr;
}

constexpr std::array kRows = {
    toggle("Window", "view-only", "Picture only", "F11",
           "The view fills the window; again, all panels are back", &viewOnly, &isViewOnly),
    separator("Window"),
    toggle("Window", "layout-lighting", "Layout for lighting", "",
           "The environment on the left, the inspector on the right", &named<1>, nullptr),
    toggle("Window", "layout-baking", "Layout for baking", "",
           "Bakes with more room, and the plan of the bake", &named<2>, nullptr),
    toggle("Window", "layout-default", "Reset layout", "", "All panels are back where they were at first",
           &named<0>, nullptr),
    scripted("layout", "A layout by its name", "default|lighting|baking", 1, 1, &useLayout),
    separator("Window"),
    toggle("Window", "left-panels", "Left panels", "", "The scene tree", &dock<Dock::Left>,
           &docked<Dock::Left>),
    toggle("Window", "right-panels", "Right panels", "", "Inspector, light, settings", &dock<Dock::Right>,
           &docked<Dock::Right>),
    toggle("Window", "bottom-panels", "Bottom panels", "", "Bakes, assets, cost, streaming, log",
           &dock<Dock::Bottom>, &docked<Dock::Bottom>),
    scripted("panel", "Bring a panel up", "NAME", 1, 1, &panel),
    scripted("move-panel", "A panel stands there from now on", "NAME left|right|below", 2, 2, &movePanel),
};

}  // namespace

std::span<const Command> layoutCommands() {
  return kRows;
}

}  // namespace lambent::editor
