// Converts values of fields to the numbers that an artist reads and drags, and back: angles in degrees,
// rotations as angles about x, y and z, the strength of lights in the chosen unit. All functions are pure.
#pragma once

#include <vector>

#include "editor/session/session.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

bool isStrengthOfLight(const scene::FieldInfo& field);
// Returns whether the field is edited as one number or three. Colors and choices are not.
bool hasNumbers(const scene::FieldInfo& field);
// Returns one number or three. The entity must have the field's component.
std::vector<double> numbersOf(const Session& session, const scene::FieldInfo& field, ecs::Entity entity,
                              const scene::Value& value);
// Returns the value with these numbers, within the field's range.
scene::Value valueOf(const Session& session, const scene::FieldInfo& field, ecs::Entity entity,
                     const std::vector<double>& numbers);
// Returns the step by which the number goes with Ctrl: that of the gizmos where they drag the same.
double stepOf(const Session& session, const scene::FieldInfo& field, double number);

}  // namespace lambent::editor
