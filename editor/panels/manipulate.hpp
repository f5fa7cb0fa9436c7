// Follows what a hand does in the view beside moving the camera: it picks what is under the pointer, drags
// the handles of what is selected and of lights, and turns suns on the sky. Every drag is one step of the
// history.
#pragma once

#include <optional>

#include "editor/gizmo/projection.hpp"
#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

// Call it right after the view's own widget. Returns the pixel of the view that was clicked to pick what is
// there, from its top left corner; nothing: no click.
std::optional<glm::vec2> manipulate(Session& session, Marks& marks, const Viewport& viewport, bool hovered);

}  // namespace lambent::editor
