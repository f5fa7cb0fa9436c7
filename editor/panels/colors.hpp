// Names the few colours that mean something in every panel.
#pragma once

#include <imgui.h>

#include "editor/session/log.hpp"
#include "editor/session/status.hpp"

namespace lambent::editor {

inline const ImVec4 kErrorColor(0.95f, 0.42f, 0.36f, 1.0f);
inline const ImVec4 kWarningColor(0.95f, 0.75f, 0.35f, 1.0f);
inline const ImVec4 kNoteColor(0.82f, 0.82f, 0.82f, 1.0f);
inline const ImVec4 kGoodColor(0.5f, 0.8f, 0.5f, 1.0f);

ImVec4 severityColor(Severity severity);
ImVec4 standingColor(Standing standing);

}  // namespace lambent::editor
