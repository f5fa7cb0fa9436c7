#include <array>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

namespace {

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

constexpr std::array kHelpRows = {
    Command{.id = "shortcuts",
            .title = "Keys and pointer",
            .menu = "Help",
            .shortcut = "F1",
            .help = "All keys, and what the pointer does in the view",
            .arguments = "",
            .run = &shortcuts},
    Command{.id = "palette",
            .title = "Command palette",
            .menu = "Help",
            .shortcut = "Ctrl+P",
            .help = "Find a command by its words, and run it",
            .arguments = "",
            .run = &palette},
    Command{.id = "about",
            .title = "About",
            .menu = "Help",
            .shortcut = "",
            .help = "Version and origin",
            .arguments = "",
            .run = &about},
    Command{.id = "commands",
            .title = "",
            .menu = "Help",
            .shortcut = "",
            .help = "All commands, as JSON",
            .arguments = "",
            .run = &commands},
};

}  // namespace

std::span<const Command> helpCommands() {
  return kHelpRows;
}

}  // namespace lambent::editor
