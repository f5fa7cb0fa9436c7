// Where panels stand: a column on each side, a row below, the view in the middle, and edges between them that
// can be dragged.
#pragma once

#include "editor/session/session.hpp"
#include "editor/ui/ui.hpp"

namespace lambent::editor {

void drawLayout(Session& session, Ui& ui);

}  // namespace lambent::editor
