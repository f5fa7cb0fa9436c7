// Sets the editor's colours, spacing and font. The font is DejaVu Sans if the system has it, else Dear
// ImGui's own.
#pragma once

namespace lambent::editor {

// Styles the current Dear ImGui context. scale: a factor on the size of text and widgets.
void setLooks(float scale);

}  // namespace lambent::editor
