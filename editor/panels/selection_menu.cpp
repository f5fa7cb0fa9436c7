#include <array>
#include <string>

#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

// An empty id is a separator.
constexpr std::array kItems = {"frame", "rename", "duplicate", "delete",    "",
                               "copy",  "paste",  "reset",     "",          "move",
                               "turn",  "scale",  "",          "frame-all", "select-none"};

constexpr std::array kCameraItems = {"look-through", "camera-to-view"};

void drawContextItem(Session& session, Marks& marks, const Command& command) {
  const bool enabled = !command.enabled || command.enabled(session);
  const bool checked = command.checked && command.checked(session);
  if (ImGui::MenuItem(command.title, command.shortcut, checked, enabled)) runOrLog(session, command.id, {});
  marks.put(std::string("context.") + command.id);
  tooltip(command.help);
}

}  // namespace

void drawSelectionMenu(Session& session, Marks& marks) {
  const Command* first = findCommand(kCameraItems.front());
  if (first && first->enabled(session)) {
    for (const char* id : kCameraItems) drawContextItem(session, marks, *findCommand(id));
    ImGui::Separator();
  }
  for (const char* id : kItems) {
    const Command* command = findCommand(id);
    if (command)
      drawContextItem(session, marks, *command);
    else
      ImGui::Separator();
  }
}

}  // namespace lambent::editor
