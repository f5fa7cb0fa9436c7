// Implements the commands for the window: layouts, docks, panels, and help.
#include <array>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

namespace {

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
       item("layout-default", "Reset layout", "", "All panels are back where they were at first",
            [](Session& session) {
              session.preferences.layout = {};
              session.window.raise_tabs = true;
            }),
       separator(), dockOf(Dock::Left, "left-panels", "Left panels", "The scene tree"),
       dockOf(Dock::Right, "right-panels", "Right panels", "Inspector, light, settings"),
       dockOf(Dock::Bottom, "bottom-panels", "Bottom panels", "Bakes, assets, cost, streaming, log"),
       scripted("panel", "Bring a panel up", "NAME", 1, 1,
                [](Session& session, Words words) { session.window.wanted_panels.push_back(words[0]); })});
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
