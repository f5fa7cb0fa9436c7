// Formats numbers for people to read, names fields in plain words, and names the few colours that mean
// something in every panel.
#pragma once

#include <string>
#include <string_view>

#include <imgui.h>

#include "editor/session/log.hpp"
#include "editor/session/status.hpp"

namespace lambent::editor {

std::string countText(double count);   // "1.2 M"
std::string bytesText(double bytes);   // "3.4 MiB"
std::string timeText(double seconds);  // "850 ms", "12 s", "1:02"

inline const ImVec4 kErrorColor(0.95f, 0.42f, 0.36f, 1.0f);
inline const ImVec4 kWarningColor(0.95f, 0.75f, 0.35f, 1.0f);
inline const ImVec4 kNoteColor(0.82f, 0.82f, 0.82f, 1.0f);
inline const ImVec4 kGoodColor(0.5f, 0.8f, 0.5f, 1.0f);

ImVec4 severityColor(Severity severity);
ImVec4 standingColor(Standing standing);

// Labels are plain words. The exact names, by which scripts and files know fields, stand in tooltips.
// Returns a label for a component's field, or for a texture of a material: "Inner cone" for inner_cone.
std::string fieldLabel(std::string_view component, std::string_view field);
// Returns a sentence about the field where its label is not enough, or an empty text.
std::string_view fieldHelp(std::string_view component, std::string_view field);

}  // namespace lambent::editor
