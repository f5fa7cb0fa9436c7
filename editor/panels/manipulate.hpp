// Handles the pointer in the view, except for the camera: it picks entities, drags the handles of the
// selection and of lights, and drags suns over the sky. Every drag is one step of the history.
#pragma once

#include <optional>

#include "editor/gizmo/projection.hpp"
#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

inline constexpr float kClickPixels = 4.0f;  // a press that moves no further is a click

// Call it right after the view's own widget. Returns the pixel at which the user clicked to pick something,
// from the view's top left corner, or none if there was no such click.
std::optional<glm::vec2> manipulate(Session& session, Marks& marks, const Viewport& viewport, bool hovered);

}  // namespace lambent::editor
