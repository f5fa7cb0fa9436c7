#include "editor/ui/dear_imgui.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include "editor/ui/ui.hpp"

namespace lambent::editor {

namespace {

// A script says which press ends a double-click; on a slow machine its frames are further apart than presses
// of a hand, and drags one after another are no double-clicks.
void tellDoubleClick(const ScriptedInput& input) {
  ImGui::GetIO().MouseDoubleClickTime = input.again ? std::numeric_limits<float>::max() : 0.0f;
}

}  // namespace

#if IMGUI_VERSION_NUM >= 18700

namespace {

constexpr std::array kNamedKeys = {
    std::pair{GLFW_KEY_DELETE, ImGuiKey_Delete},  std::pair{GLFW_KEY_ESCAPE, ImGuiKey_Escape},
    std::pair{GLFW_KEY_SPACE, ImGuiKey_Space},    std::pair{GLFW_KEY_ENTER, ImGuiKey_Enter},
    std::pair{GLFW_KEY_TAB, ImGuiKey_Tab},        std::pair{GLFW_KEY_HOME, ImGuiKey_Home},
    std::pair{GLFW_KEY_LEFT, ImGuiKey_LeftArrow}, std::pair{GLFW_KEY_RIGHT, ImGuiKey_RightArrow},
    std::pair{GLFW_KEY_UP, ImGuiKey_UpArrow},     std::pair{GLFW_KEY_DOWN, ImGuiKey_DownArrow},
    std::pair{GLFW_KEY_COMMA, ImGuiKey_Comma},    std::pair{GLFW_KEY_BACKSPACE, ImGuiKey_Backspace}};

// Returns ImGuiKey_None for a key that no shortcut has.
ImGuiKey keyOf(int glfw_key) {
  const auto inRow = [&](int first, int last, ImGuiKey named) {
    return first <= glfw_key && glfw_key <= last ? static_cast<ImGuiKey>(named + (glfw_key - first))
                                                 : ImGuiKey_None;
  };
  for (const auto& [from, to] : kNamedKeys)
    if (from == glfw_key) return to;
  if (const ImGuiKey key = inRow('A', 'Z', ImGuiKey_A); key != ImGuiKey_None) return key;
  if (const ImGuiKey key = inRow('0', '9', ImGuiKey_0); key != ImGuiKey_None) return key;
  return inRow(GLFW_KEY_F1, GLFW_KEY_F12, ImGuiKey_F1);
}

// Calls a function with each key of the keyboard. Those of the gamepad and the mouse come behind them.
template <typename Function>
void forEachKey(Function function) {
  for (int key = ImGuiKey_NamedKey_BEGIN; key < ImGuiKey_GamepadStart; ++key)
    function(static_cast<ImGuiKey>(key));
}

#if IMGUI_VERSION_NUM >= 18900
constexpr ImGuiKey kCtrl = ImGuiMod_Ctrl, kShift = ImGuiMod_Shift, kAlt = ImGuiMod_Alt;
#else
constexpr ImGuiKey kCtrl = ImGuiKey_ModCtrl, kShift = ImGuiKey_ModShift, kAlt = ImGuiKey_ModAlt;
#endif

}  // namespace

bool keyPressed(int glfw_key, bool repeat) {
  const ImGuiKey key = keyOf(glfw_key);
  return key != ImGuiKey_None && ImGui::IsKeyPressed(key, repeat);
}

bool keyHeld(int glfw_key) {
  const ImGuiKey key = keyOf(glfw_key);
  return key != ImGuiKey_None && ImGui::IsKeyDown(key);
}

bool anyKeyHeld() {
  bool any = false;
  forEachKey([&](ImGuiKey key) { any = any || ImGui::IsKeyDown(key); });
  return any;
}

void apply(const ScriptedInput& input) {
  ImGuiIO& io = ImGui::GetIO();
  tellDoubleClick(input);
  // A script says what happens in which frame, so events are not spread over several.
  io.ConfigInputTrickleEventQueue = false;
  if (input.pointer) io.AddMousePosEvent(input.pointer->x, input.pointer->y);
  io.AddMouseButtonEvent(ImGuiMouseButton_Left, input.left);
  io.AddMouseButtonEvent(ImGuiMouseButton_Right, input.right);
  io.AddMouseButtonEvent(ImGuiMouseButton_Middle, input.middle);
  if (input.wheel != 0.0f) io.AddMouseWheelEvent(0.0f, input.wheel);
  io.AddKeyEvent(kCtrl, input.ctrl);
  io.AddKeyEvent(kShift, input.shift);
  io.AddKeyEvent(kAlt, input.alt);
  const ImGuiKey pressed = keyOf(input.key);
  forEachKey([&](ImGuiKey key) { io.AddKeyEvent(key, key == pressed); });
  if (!input.text.empty()) io.AddInputCharactersUTF8(input.text.c_str());
}

#else  // Keys are numbered as GLFW numbers them, and input is written where it is read.

bool keyPressed(int glfw_key, bool repeat) {
  return ImGui::IsKeyPressed(glfw_key, repeat);
}

bool keyHeld(int glfw_key) {
  return ImGui::IsKeyDown(glfw_key);
}

bool anyKeyHeld() {
  return std::ranges::any_of(ImGui::GetIO().KeysDown, [](bool down) { return down; });
}

void apply(const ScriptedInput& input) {
  ImGuiIO& io = ImGui::GetIO();
  tellDoubleClick(input);
  if (input.pointer) io.MousePos = ImVec2(input.pointer->x, input.pointer->y);
  io.MouseDown[0] = input.left;
  io.MouseDown[1] = input.right;
  io.MouseDown[2] = input.middle;
  io.MouseWheel = input.wheel;
  io.KeyCtrl = input.ctrl;
  io.KeyShift = input.shift;
  io.KeyAlt = input.alt;
  std::ranges::fill(io.KeysDown, false);
  if (input.key >= 0) io.KeysDown[input.key] = true;
  if (!input.text.empty()) io.AddInputCharactersUTF8(input.text.c_str());
}

#endif

bool escapePressed() {
  return keyPressed(GLFW_KEY_ESCAPE);
}

namespace {

constexpr std::string_view kEllipsis = "...";
constexpr float kTooltipEms = 32.0f;

float widthOf(std::string_view text) {
  return ImGui::CalcTextSize(text.data(), text.data() + text.size()).x;
}

}  // namespace

float em(float heights) {
  return heights * ImGui::GetFontSize();
}

std::string ellipsized(std::string_view text, float width) {
  if (widthOf(text) <= width) return std::string(text);
  const float room = width - widthOf(kEllipsis);
  std::size_t fits = 0, too_long = text.size();
  while (fits + 1 < too_long) {
    const std::size_t middle = (fits + too_long) / 2;
    (widthOf(text.substr(0, middle)) <= room ? fits : too_long) = middle;
  }
  // A character of several bytes is left out whole.
  while (fits > 0 && (static_cast<unsigned char>(text[fits]) & 0xc0u) == 0x80u) --fits;
  return std::string(text.substr(0, fits)).append(kEllipsis);
}

void tooltip(std::string_view text) {
  if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(em(kTooltipEms));
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void fittedText(std::string_view text, std::string_view more) {
  const std::string shown = ellipsized(text, ImGui::GetContentRegionAvail().x);
  ImGui::TextUnformatted(shown.c_str());
  if (shown == text)
    tooltip(more);
  else
    tooltip(more.empty() ? std::string(text) : fmt::format("{}\n{}", text, more));
}

void fittedText(const ImVec4& color, std::string_view text, std::string_view more) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  fittedText(text, more);
  ImGui::PopStyleColor();
}

ImVec4 dimmed() {
  return ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled);
}

bool sameLineIfFits(std::string_view button) {
  return sameLineIfFits(widthOf(button) + 2.0f * ImGui::GetStyle().FramePadding.x);
}

bool sameLineIfFits(float width) {
  const float end = ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width;
  if (end > ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x) return false;
  ImGui::SameLine();
  return true;
}

const char* numberFormat(float value, float width, int digits) {
  constexpr std::array kFormats = {"%.0f", "%.1f", "%.2f", "%.3f", "%.4f"};
  const float room = width - 2.0f * ImGui::GetStyle().FramePadding.x;
  int shown = std::clamp(digits, 0, static_cast<int>(kFormats.size()) - 1);
  while (shown > 0 && widthOf(fmt::format("{:.{}f}", value, shown)) > room) --shown;
  return kFormats[static_cast<std::size_t>(shown)];
}

void Marks::beginFrame() {
  before_ = std::exchange(now_, {});
  times_.clear();
}

void Marks::put(std::string_view name) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  // A tab has no size in its first frame, and cannot be clicked.
  if (low.x >= high.x && low.y >= high.y) return;
  const ImVec2 middle(0.5f * (low.x + high.x), 0.5f * (low.y + high.y));
  // Rows that span all columns of a table are drawn while only their first column is within the clip
  // rectangle.
  const float left = ImGui::GetWindowPos().x, right = left + ImGui::GetWindowWidth();
  const bool shown = left <= middle.x && middle.x < right &&
                     ImGui::IsRectVisible({low.x, middle.y - 0.5f}, {high.x, middle.y + 0.5f});
  put(name, {{low.x, low.y}, {high.x, high.y}, shown});
}

void Marks::put(std::string_view name, const Rectangle& where) {
  std::uint32_t& times = times_[std::string(name)];
  std::string own(name);
  if (++times > 1) own += '#' + std::to_string(times);
  // Another widget may already have the name NAME#2.
  while (!now_.try_emplace(own, where).second) own = std::string(name) + '#' + std::to_string(++times);
}

std::optional<Rectangle> Marks::find(std::string_view name) const {
  const auto found = before_.find(name);
  return found == before_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> Marks::names() const {
  std::vector<std::string> names;
  for (const auto& [name, where] : before_) names.push_back(name);
  return names;
}

}  // namespace lambent::editor
