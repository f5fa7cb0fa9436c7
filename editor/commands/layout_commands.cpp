#include <array>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

namespace {

// Returns the names of all layouts, for hints.
std::string layoutNames(const Session& session) {
  std::string names = "default, lighting, baking";
  for (const auto& [name, layout] : session.preferences.layouts) names += ", " + name;
  return names;
}

Answer useLayout(Session& session, Words words) {
  const auto saved = session.preferences.layouts.find(words[0]);
  const auto layout =
      saved == session.preferences.layouts.end() ? layoutNamed(words[0]) : std::optional(saved->second);
  if (!layout)
    return fail("layout", "\"" + words[0] + "\" is not known", "there are " + layoutNames(session));
  session.preferences.layout = *layout;
  session.window.raise_tabs = true;
  return nullptr;
}

Answer saveLayout(Session& session, Words words) {
  if (!words.empty()) {
    if (words[0].empty()) return fail("save-layout", "the name is empty", "give the layout a name");
    if (layoutNamed(words[0]))
      return fail("save-layout", "\"" + words[0] + "\" comes with the program", "give another name");
    session.preferences.layouts[words[0]] = session.preferences.layout;
    return nullptr;
  }
  Dialog ask;
  ask.kind = Dialog::Kind::Text;
  ask.title = "Save the layout";
  ask.question = "Its name. A layout that has it already is replaced.";
  ask.yes = "Save";
  ask.answered = [](Session& s, const std::string& name) { runOrLog(s, "save-layout", std::array{name}); };
  session.window.dialog = std::move(ask);
  return nullptr;
}

Answer deleteLayout(Session& session, Words words) {
  if (session.preferences.layouts.erase(words[0]) == 0)
    return fail("delete-layout", "\"" + words[0] + "\" was not saved", "there are " + layoutNames(session));
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

Answer shortcuts(Session& session, Words) {
  session.window.keys = true;
  return nullptr;
}

Answer palette(Session& session, Words) {
  session.window.palette = true;
  session.window.palette_words.clear();
  return nullptr;
}

Answer about(Session& session, Words) {
  Dialog show;
  show.kind = Dialog::Kind::Confirm;
  show.title = "Lambent " LAMBENT_VERSION;
  show.question =
      "Bake a glTF scene once, light it any way you like.\n"
      "Precomputed radiance transfer: Sloan, Kautz and Snyder, SIGGRAPH 2002.";
  show.yes = "Close", show.no = "OK";
  session.window.dialog = std::move(show);
  return nullptr;
}

Answer commands(Session&, Words) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Command& command : commandList())
    if (*command.id != '\0')
      rows.push_back({{"id", command.id},
                      {"arguments", command.arguments},
                      {"help", command.help},
                      {"menu", command.menu},
                      {"title", command.title},
                      {"shortcut", command.shortcut}});
  return rows;
}

constexpr std::array kLayoutRows = {
    toggle(&isViewOnly, item("Window", "view-only", "Picture only", "F11",
                             "The view fills the window; again, all panels are back", &viewOnly)),
    separator("Window"),
    item("Window", "layout-lighting", "Layout for lighting", "",
         "The environment on the left, the inspector on the right", &named<1>),
    item("Window", "layout-baking", "Layout for baking", "", "Bakes with more room, and the plan of the bake",
         &named<2>),
    item("Window", "layout-default", "Reset layout", "", "All panels are back where they were at first",
         &named<0>),
    withWords("NAME", 1, 1,
              item("Window", "save-layout", "Save layout as...", "",
                   "Keep the present layout under a name, which this menu then lists", &saveLayout)),
    scripted("delete-layout", "Forget a layout that was saved", "NAME", 1, 1, &deleteLayout),
    scripted("layout", "A layout by its name", "default|lighting|baking|NAME", 1, 1, &useLayout),
    separator("Window"),
    toggle(&docked<Dock::Left>,
           item("Window", "left-panels", "Left panels", "", "The scene tree", &dock<Dock::Left>)),
    toggle(&docked<Dock::Right>, item("Window", "right-panels", "Right panels", "",
                                      "Inspector, light, settings", &dock<Dock::Right>)),
    toggle(&docked<Dock::Bottom>, item("Window", "bottom-panels", "Bottom panels", "",
                                       "Bakes, assets, cost, streaming, log", &dock<Dock::Bottom>)),
    scripted("panel", "Bring a panel up", "NAME", 1, 1, &panel),
    scripted("move-panel", "A panel stands there from now on", "NAME left|right|below", 2, 2, &movePanel),
    item("Help", "shortcuts", "Keys and pointer", "F1", "All keys, and what the pointer does in the view",
         &shortcuts),
    item("Help", "palette", "Command palette", "Ctrl+P", "Find a command by its words, and run it", &palette),
    item("Help", "about", "About", "", "Version and origin", &about),
    item("Help", "commands", "", "", "All commands, as JSON", &commands),
};

}  // namespace

std::span<const Command> layoutCommands() {
  return kLayoutRows;
}

}  // namespace lambent::editor
