// What a hand does in the view beside moving the eye: picks what is under the pointer, drags the handles of
// what is selected and of lights, turns suns on the sky. Every drag is one step of the history.
#pragma once

#include "editor/gizmo/projection.hpp"
#include "editor/session/session.hpp"
#include "editor/ui/ui.hpp"

namespace lambent::editor {

// Right after the view's own item.
void manipulate(Session& session, Ui& ui, const Viewport& viewport, bool hovered);

}  // namespace lambent::editor
