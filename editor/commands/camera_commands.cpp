// Implements the commands for cameras that stand in the world.
#include <array>

#include "editor/commands/rows.hpp"
#include "editor/session/camera_views.hpp"

namespace lambent::editor {

namespace {

bool cameraSelected(const Session& session) {
  return session.document.registry().alive(selectedCamera(session));
}

Answer look(Session& session, Words) {
  lookThrough(session, selectedCamera(session));
  return nullptr;
}
Answer place(Session& session, Words) {
  return answerOf(placeAtView(session, selectedCamera(session)));
}
Answer preview(Session& session, Words) {
  session.preferences.camera_preview = !session.preferences.camera_preview;
  return nullptr;
}
bool previews(const Session& session) {
  return session.preferences.camera_preview;
}

constexpr std::array kRows = {
    separator("View"),
    Command{.id = "look-through",
            .title = "Look through this camera",
            .menu = "View",
            .shortcut = "C",
            .help = "The view goes where the selected camera stands",
            .arguments = "",
            .run = &look,
            .enabled = &cameraSelected},
    Command{.id = "camera-to-view",
            .title = "Camera to view",
            .menu = "View",
            .shortcut = "Shift+C",
            .help = "The selected camera goes where the view is",
            .arguments = "",
            .run = &place,
            .enabled = &cameraSelected},
    Command{.id = "camera-preview",
            .title = "Camera preview",
            .menu = "View",
            .shortcut = "",
            .help = "An inset in the view shows what a selected camera sees",
            .arguments = "",
            .run = &preview,
            .checked = &previews},
};

}  // namespace

std::span<const Command> cameraCommands() {
  return kRows;
}

}  // namespace lambent::editor
