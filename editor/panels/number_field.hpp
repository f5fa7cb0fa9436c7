// Draws a number that is dragged or typed, with the modifiers that the gizmos have, too: Shift is finer, Ctrl
// goes in steps, Alt is coarser. A click opens a text field that calculates (document/field_edits.hpp). The
// edit is returned, not applied, so that it can reach several entities.
#pragma once

#include <optional>

#include "editor/document/field_edits.hpp"
#include "editor/session/field_numbers.hpp"

namespace lambent::editor {

struct NumberLook {
  double speed = 0.01;             // for a pixel of a drag
  double least = 0.0, most = 0.0;  // equal: no limits
  const char* format = "%.3f";     // of printf
  double step = 0.1;               // with Ctrl
  bool mixed = false;              // the selected ones differ: shows a dash
  bool scales = false;             // a drag multiplies, so that several keep their ratios
};

// The edit is relative to the number that was shown when the widget became active. It is returned again
// whenever it changes.
std::optional<NumberEdit> dragNumber(const char* label, double shown, const NumberLook& look,
                                     HeldNumber& held);
// The same for a single number, to which the edit is applied. Returns whether it changed.
bool dragNumber(const char* label, float& number, const NumberLook& look, HeldNumber& held);

// Tooltips of numbers end in this.
inline constexpr const char* kNumberHelp =
    "Drag; Shift: finer, Alt: coarser, Ctrl: in steps. Click to type: 2*3, +=1, *2";
// Stands for values that differ.
inline constexpr const char* kMixedText = "—";

}  // namespace lambent::editor
