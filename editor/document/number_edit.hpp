// Describes what a widget or typed text does to a number, so that the same can be done to that number of each
// selected entity: set it, shift it, or scale it. Typed text may calculate: "2*3" sets 6, "+=1" shifts by 1,
// "*2" and "/=4" scale.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace lambent::editor {

struct NumberEdit {
  enum class Kind : std::uint8_t { Set, Add, Multiply };
  Kind kind = Kind::Set;
  double amount = 0.0;

  double appliedTo(double number) const;
};

// Returns nothing if the text is no number and no calculation with a finite result.
std::optional<NumberEdit> parseNumberEdit(std::string_view text);

}  // namespace lambent::editor
