// Connects cameras that stand in the world with the editor's own: what a camera sees, looking through it, and
// placing it where the view is.
#pragma once

#include "editor/session/session.hpp"

namespace lambent::editor {

// Returns the primary selected entity if it is a camera, or none.
ecs::Entity selectedCamera(const Session& session);
// Returns the camera whose picture the view shows as an inset: the selected one, as far as the preferences
// want that, or else the one that is kept, or none.
ecs::Entity shownCamera(const Session& session);
// Returns width over height of the camera's picture: its own, or that of the view.
float aspectOf(const Session& session, ecs::Entity camera);
// Returns what the camera sees. Errors: its matrix is singular.
Result<spec::View> viewOfCamera(const Session& session, ecs::Entity camera, float aspect);
// Moves the editor's view to the camera. Its roll is lost.
void lookThrough(Session& session, ecs::Entity camera);
// Places the camera where the view is and gives it the view's angle, as one step.
Result<void> placeAtView(Session& session, ecs::Entity camera);

}  // namespace lambent::editor
