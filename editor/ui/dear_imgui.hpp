// Includes Dear ImGui, of any version from 1.86 on, and hides what differs between the versions: how keys
// are named and asked for, how a script's input is handed over, and names that were changed. It also fits
// text into the room that there is. It keeps no state. Main thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <imgui.h>

namespace lambent::editor {

struct ScriptedInput;

// Both take a key as GLFW names it. keyPressed() is true in the frame in which the key goes down, and again
// while it is held, if it is to repeat.
bool keyPressed(int glfw_key, bool repeat = true);
bool keyHeld(int glfw_key);
bool anyKeyHeld();
bool escapePressed();

// Hands over a script's input for the frame that NewFrame() is about to begin. Keys and buttons that are not
// in it are released.
void apply(const ScriptedInput& input);

// Returns what Dear ImGui's functions take for an OpenGL texture: an address until 1.91.3, then a number.
inline ImTextureID textureOf(std::uint32_t gl_name) {
  return (ImTextureID)(std::uintptr_t{gl_name});  // no other cast does both
}

#if IMGUI_VERSION_NUM >= 18970
inline constexpr ImGuiTreeNodeFlags kTreeNodeAllowOverlap = ImGuiTreeNodeFlags_AllowOverlap;
inline constexpr ImGuiSelectableFlags kSelectableAllowOverlap = ImGuiSelectableFlags_AllowOverlap;
#else
inline constexpr ImGuiTreeNodeFlags kTreeNodeAllowOverlap = ImGuiTreeNodeFlags_AllowItemOverlap;
inline constexpr ImGuiSelectableFlags kSelectableAllowOverlap = ImGuiSelectableFlags_AllowItemOverlap;
#endif

#if IMGUI_VERSION_NUM >= 19090
inline constexpr ImGuiCol kColorOfOpenTab = ImGuiCol_TabSelected;
#else
inline constexpr ImGuiCol kColorOfOpenTab = ImGuiCol_TabActive;
#endif

#if IMGUI_VERSION_NUM >= 19140
inline constexpr ImGuiCol kColorOfKeyboardCursor = ImGuiCol_NavCursor;
#else
inline constexpr ImGuiCol kColorOfKeyboardCursor = ImGuiCol_NavHighlight;
#endif

// Returns so many heights of the font, in pixels. Sizes that hold text are given in these.
float em(float heights);

// Returns the text, or as much of its beginning as fits into the width with an ellipsis behind it.
std::string ellipsized(std::string_view text, float width);

// Draws a line of text that ends in an ellipsis where the room ends. Its tooltip then begins with the whole
// text; `more`, if there is any, follows or is all of the tooltip.
void fittedText(std::string_view text, std::string_view more = {});
// The same in a color.
void fittedText(const ImVec4& color, std::string_view text, std::string_view more = {});
// The color of what matters less.
ImVec4 dimmed();

// Shows a wrapped tooltip for the last widget while the pointer is over it. Without text there is none.
void tooltip(std::string_view text);

// Goes on in the same line if a button with this text, or a widget of this width in pixels, fits there.
// Returns whether it does.
bool sameLineIfFits(std::string_view button);
bool sameLineIfFits(float width);

// Returns a printf format with as many digits as fit into the width for this value, at most `digits` behind
// the point.
const char* numberFormat(float value, float width, int digits);

}  // namespace lambent::editor
