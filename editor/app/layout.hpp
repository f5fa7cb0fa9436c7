// Draws the window's contents: a column of panels on each side, a row of them below, the view in the middle,
// and edges between them that can be dragged. A tab's menu moves its panel to another dock, as dragging the
// tab there does.
#pragma once

#include "editor/render/renderer.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

void drawLayout(Session& session, Renderer& renderer, Marks& marks);

}  // namespace lambent::editor
