#include <array>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

namespace {

Answer shortcuts(Session& session, Words) {
  std::string text;
  for (const Command& command : commandList())
    if (*command.shortcut != '\0') text += fmt::format("{:<14} {}\n", command.shortcut, command.title);
  text +=
      "\nMiddle button, or Alt and left: turn the eye; with Shift: shift it; wheel: nearer, farther\n"
      "Right button: look around; with W A S D Q E: fly, with Shift faster\n"
      "Click: select; with Ctrl or Shift: several; double click in the tree: frame";
  Dialog show;
  show.kind = Dialog::Kind::Confirm;
  show.title = "Keys and pointer";
  show.question = text;
  show.yes = "Close", show.no = "OK";
  session.window.dialog = std::move(show);
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

constexpr std::array kRows = {
    Command{.id = "shortcuts",
            .title = "Keys and pointer",
            .menu = "Help",
            .shortcut = "F1",
            .help = "All keys, and what the pointer does in the view",
            .arguments = "",
            .run = &shortcuts},
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
  return kRows;
}

}  // namespace lambent::editor
