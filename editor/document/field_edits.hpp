// Answers what inspectors ask about fields: which of them mean something, and what a widget or typed text
// does to a number, so that the same can be done to that number of each selected entity.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "runtime/ecs/registry.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

// Returns whether a field means something with the component's present values: a point light has no radius,
// and only a spot light has cones. Inspectors leave the others out; files and scripts have all fields. The
// entity must have the field's component.
bool isUsed(const ecs::Registry& registry, ecs::Entity entity, const scene::FieldInfo& field);

// Sets a number, shifts it, or scales it. Typed text may calculate: "2*3" sets 6, "+=1" shifts by 1, "*2"
// and "/=4" scale.
struct NumberEdit {
  enum class Kind : std::uint8_t { Set, Add, Multiply };
  Kind kind = Kind::Set;
  double amount = 0.0;

  double appliedTo(double number) const;
};

// Returns nothing if the text is no number and no calculation with a finite result.
std::optional<NumberEdit> parseNumberEdit(std::string_view text);

}  // namespace lambent::editor
