#include "editor/panels/number_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

constexpr double kFine = 0.1, kCoarse = 10.0;

std::string formatted(const char* format, double number) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, number);
  return text.data();
}

HeldNumber begun(ImGuiID widget, double shown) {
  HeldNumber held;
  held.widget = widget;
  held.start = held.dragged = held.told = shown;
  return held;
}

// Returns the format without the unit that follows the number.
std::string withoutUnit(std::string_view format) {
  return std::string(format.substr(0, format.find_first_of("fgd") + 1));
}

// Returns what the pointer makes of the number, and keeps the drag in `held`.
std::optional<NumberEdit> drag(const char* label, double shown, const NumberLook& look, HeldNumber& held) {
  ImGuiIO& io = ImGui::GetIO();
  const ImGuiID widget = ImGui::GetID(label);
  const bool active = ImGui::GetActiveID() == widget && held.widget == widget;
  double number = active ? held.dragged : shown;
  // Dear ImGui has Shift for ten times as fast and Alt for a hundredth.
  const double factor = (io.KeyShift ? 0.1 * kFine : 1.0) * (io.KeyAlt ? 100.0 * kCoarse : 1.0);
  const bool steps = io.KeyCtrl && look.step > 0.0;
  const bool moved = active && held.told != held.start;
  const char* format = look.mixed ? kMixedText : look.format;
  std::string literal;
  if (moved && (steps || look.mixed)) {
    literal = look.mixed && look.scales ? formatted("× %.3g", held.told / held.start)
              : look.mixed              ? formatted("%+.4g", held.told - held.start)
                                        : formatted(look.format, held.told);
    format = literal.c_str();
  }
  // Dear ImGui opens a text field for a press with Ctrl. A click without one does so here.
  const bool ctrl = std::exchange(io.KeyCtrl, false);
  ImGui::DragScalar(label, ImGuiDataType_Double, &number, static_cast<float>(look.speed * factor),
                    &look.least, &look.most, format, ImGuiSliderFlags_NoRoundToFormat);
  io.KeyCtrl = ctrl;
  if (ImGui::IsItemActivated()) held = begun(widget, shown);
  // When the button is released, the modifiers may be, too, and no longer count.
  if (!active || ImGui::GetActiveID() != widget || ImGui::TempInputIsActive(widget)) return std::nullopt;
  held.dragged = number;
  double to = steps && number != held.start ? std::round(number / look.step) * look.step : number;
  if (look.least < look.most) to = std::clamp(to, look.least, look.most);
  if (escapePressed()) {
    to = held.start;
    ImGui::ClearActiveID();
  }
  if (to == held.told) return std::nullopt;
  held.told = to;
  if (look.scales && held.start != 0.0) return NumberEdit{NumberEdit::Kind::Multiply, to / held.start};
  return NumberEdit{NumberEdit::Kind::Add, to - held.start};
}

// Returns what the typed text makes of the number, while it is typed.
std::optional<NumberEdit> type(const char* label, double shown, const NumberLook& look, HeldNumber& held) {
  const ImGuiID widget = ImGui::GetID(label);
  if (held.widget != widget) held = begun(widget, shown);
  if (held.text.empty())
    held.text = held.typed = look.mixed ? kMixedText : formatted(withoutUnit(look.format).c_str(), shown);
  std::string text = held.text;
  ImGui::InputText(label, &text, ImGuiInputTextFlags_AutoSelectAll);
  if (text == held.typed) return std::nullopt;
  held.typed = text;
  if (text == held.text) return NumberEdit{NumberEdit::Kind::Add, 0.0};  // Escape, or typed back
  return parseNumberEdit(text);
}

}  // namespace

std::optional<NumberEdit> dragNumber(const char* label, double shown, const NumberLook& look,
                                     HeldNumber& held) {
  const bool typing = ImGui::TempInputIsActive(ImGui::GetID(label));
  return typing ? type(label, shown, look, held) : drag(label, shown, look, held);
}

bool dragNumber(const char* label, float& number, const NumberLook& look, HeldNumber& held) {
  const auto edit = dragNumber(label, double{number}, look, held);
  if (!edit) return false;
  double to = edit->appliedTo(held.start);
  if (look.least < look.most) to = std::clamp(to, look.least, look.most);
  number = static_cast<float>(to);
  return true;
}

}  // namespace lambent::editor
