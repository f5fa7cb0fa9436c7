// Implements the commands for cameras that stand in the world.
#include <array>

#include "editor/commands/rows.hpp"
#include "editor/session/viewing.hpp"

namespace lambent::editor {

namespace {

bool cameraSelected(const Session& session) {
  return session.document.registry().alive(selectedCamera(session));
}

// Returns the selected camera, or else the one whose picture is kept.
ecs::Entity cameraAtHand(const Session& session) {
  return cameraSelected(session) ? selectedCamera(session) : shownCamera(session);
}
bool anyCamera(const Session& session) {
  return session.document.registry().alive(cameraAtHand(session));
}

Answer look(Session& session, Words) {
  lookThrough(session, cameraAtHand(session));
  return nullptr;
}
Answer keep(Session& session, Words) {
  ecs::Entity& kept = session.viewing.kept_camera;
  const ecs::Entity selected = selectedCamera(session);  // none gives up the kept one
  kept = kept == selected ? ecs::Entity{} : selected;
  return nullptr;
}
bool keeps(const Session& session) {
  return session.document.registry().alive(session.viewing.kept_camera);
}
bool mayKeep(const Session& session) {
  return cameraSelected(session) || keeps(session);
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

constexpr std::array kCameraRows = {
    separator("View"),
    Command{.id = "look-through",
            .title = "Look through this camera",
            .menu = "View",
            .shortcut = "C",
            .help = "The view goes where the selected camera stands, or the one whose picture is kept",
            .arguments = "",
            .run = &look,
            .enabled = &anyCamera},
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
    Command{.id = "keep-camera",
            .title = "Keep this camera's picture",
            .menu = "View",
            .shortcut = "",
            .help = "The inset stays while other things are selected and edited: a second view",
            .arguments = "",
            .run = &keep,
            .enabled = &mayKeep,
            .checked = &keeps},
};

}  // namespace

std::span<const Command> cameraCommands() {
  return kCameraRows;
}

}  // namespace lambent::editor
