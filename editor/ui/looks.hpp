// Sets how the editor looks: colours, spacing, the font. The font is DejaVu Sans where the system has it,
// else Dear ImGui's own.
#pragma once

namespace lambent::editor {

// Styles the current Dear ImGui context. scale: factor on the size of text and widgets.
void setLooks(float scale);

}  // namespace lambent::editor
