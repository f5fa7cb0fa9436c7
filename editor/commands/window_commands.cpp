// Implements the commands for the window: layouts, docks, panels, and help.
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

Result<void> useLayout(Session& session, const std::string& name) {
  const auto saved = session.preferences.layouts.find(name);
  const auto layout =
      saved == session.preferences.layouts.end() ? layoutNamed(name) : std::optional(saved->second);
  if (!layout) return fail("layout", "\"" + name + "\" is not known", "there are " + layoutNames(session));
  session.preferences.layout = *layout;
  session.window.raise_tabs = true;
  return {};
}

Result<void> saveLayout(Session& session, Words words) {
  if (words.empty()) {
    session.window.dialog = Dialog{.kind = Dialog::Kind::Text,
                                   .title = "Save the layout",
                                   .question = "Its name. A layout that has it already is replaced.",
                                   .yes = "Save",
                                   .answered = [](Session& s, const std::string& name) {
                                     runOrLog(s, "save-layout", std::array{name});
                                   }};
    return {};
  }
  if (words[0].empty()) return fail("save-layout", "the name is empty", "give the layout a name");
  if (layoutNamed(words[0]))
    return fail("save-layout", "\"" + words[0] + "\" comes with the program", "give another name");
  session.preferences.layouts[words[0]] = session.preferences.layout;
  return {};
}

Result<void> deleteLayout(Session& session, Words words) {
  if (session.preferences.layouts.erase(words[0]) == 0)
    return fail("delete-layout", "\"" + words[0] + "\" was not saved", "there are " + layoutNames(session));
  return {};
}

Command layoutOf(const char* name, const char* id, const char* title, const char* help) {
  return item(id, title, "", help, [name](Session& session) { return useLayout(session, name); });
}

// Shows or hides a dock. Where only the view is shown, all come back.
Command dockOf(Dock dock, const char* id, const char* title, const char* help) {
  return item(id, title, "", help,
              [dock](Session& session) {
                WindowLayout& layout = session.preferences.layout;
                bool& shown = layout.of(dock).shown;
                shown = layout.view_only || !shown;
                layout.view_only = false;
              })
      .checkedIf([dock](const Session& session) {
        const WindowLayout& layout = session.preferences.layout;
        return layout.of(dock).shown && !layout.view_only;
      });
}

Result<void> movePanel(Session& session, Words words) {
  const auto to = parseDock(words[1]);
  if (!to) return fail("move-panel", "\"" + words[1] + "\" is no place", "give left, right or below");
  session.preferences.layout.moved[words[0]] = *to;
  session.window.wanted_panels.push_back(words[0]);
  return {};
}

void showAbout(Session& session) {
  session.window.dialog = Dialog{.title = "Lambent " LAMBENT_VERSION,
                                 .question =
                                     "Bake a glTF scene once, light it any way you like.\n"
                                     "Precomputed radiance transfer: Sloan, Kautz and Snyder, SIGGRAPH 2002.",
                                 .yes = "Close",
                                 .no = "OK"};
}

Answer listCommands(Session&) {
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

}  // namespace

std::vector<Command> windowCommands() {
  std::vector<Command> window = inMenu(
      "Window",
      {toggle(
           "view-only", "Picture only", "F11", "The view fills the window; again, all panels are back",
           [](auto& session) -> auto& { return session.preferences.layout.view_only; }),
       separator(),
       layoutOf("lighting", "layout-lighting", "Layout for lighting",
                "The environment on the left, the inspector on the right"),
       layoutOf("baking", "layout-baking", "Layout for baking",
                "Bakes with more room, and the plan of the bake"),
       layoutOf("default", "layout-default", "Reset layout", "All panels are back where they were at first"),
       item("save-layout", "Save layout as...", "",
            "Keep the present layout under a name, which this menu then lists", saveLayout)
           .taking("NAME", 1, 1),
       scripted("delete-layout", "Forget a layout that was saved", "NAME", 1, 1, deleteLayout),
       scripted("layout", "A layout by its name", "default|lighting|baking|NAME", 1, 1,
                [](Session& session, Words words) { return useLayout(session, words[0]); }),
       separator(), dockOf(Dock::Left, "left-panels", "Left panels", "The scene tree"),
       dockOf(Dock::Right, "right-panels", "Right panels", "Inspector, light, settings"),
       dockOf(Dock::Bottom, "bottom-panels", "Bottom panels", "Bakes, assets, cost, streaming, log"),
       scripted("panel", "Bring a panel up", "NAME", 1, 1,
                [](Session& session, Words words) { session.window.wanted_panels.push_back(words[0]); }),
       scripted("move-panel", "A panel stands there from now on", "NAME left|right|below", 2, 2, movePanel)});
  const std::vector<Command> help = inMenu(
      "Help", {item("shortcuts", "Keys and pointer", "F1", "All keys, and what the pointer does in the view",
                    [](Session& session) { session.window.keys = true; }),
               item("palette", "Command palette", "Ctrl+P", "Find a command by its words, and run it",
                    [](Session& session) {
                      session.window.palette = true;
                      session.window.palette_words.clear();
                    }),
               item("about", "About", "", "Version and origin", showAbout),
               scripted("commands", "All commands, as JSON", "", 0, 0, listCommands)});
  window.insert(window.end(), help.begin(), help.end());
  return window;
}

}  // namespace lambent::editor
