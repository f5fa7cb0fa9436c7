// Converts values of fields to the numbers that an artist reads and drags, and back: angles in degrees,
// rotations as angles about x, y and z, the strength of lights in the chosen unit. It also holds what the
// inspector must know from one frame to the next while a field is edited.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

class Session;

// A unit in which lamps are sold and measured. Components store candela for point and spot lights, lux for
// directional ones and cd/m² for spheres and discs (1 cd = 1 W/sr up to the global scale of all light).
struct LightUnit {
  std::string_view name;  // "lm"
  std::string_view help;  // what it measures
  double factor = 1.0;    // value in this unit for each unit of the component's strength; > 0
};

// Returns the units in which this light can be given, that of the component first. Colour counts as white.
std::vector<LightUnit> unitsOf(const scene::LocalLightComponent& light);
// Returns the unit of this name, or the first if the light has none of that name.
LightUnit unitOf(const scene::LocalLightComponent& light, std::string_view name);

// Holds the angles of the rotation that a field shows. Many angles give one rotation, so a field that made
// them anew from the rotation in each frame would jump to others while it is dragged beyond 90 degrees.
struct HeldAngles {
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 degrees{0.0f};
};

// Holds a number while its widget is active. An edit is always relative to the number at the beginning, so
// that steps do not add up rounding errors and a drag that comes back restores it.
struct HeldNumber {
  std::uint32_t widget = 0;  // id; 0: none
  double start = 0.0;
  double dragged = 0.0;  // where the pointer has dragged it, before it snaps to steps
  double told = 0.0;     // the number of the last edit
  std::string text;      // what a text field began with; empty: none is open
  std::string typed;     // the text of the last edit
};

// Holds the field's values of the selected entities as they were when its widget became active, each also as
// the numbers that the widget shows.
struct HeldField {
  std::vector<scene::Value> values;
  std::vector<std::vector<double>> numbers;
};

struct FieldEditState {
  HeldAngles angles;
  HeldNumber number;
  HeldField field;
};

bool isStrengthOfLight(const scene::FieldInfo& field);
bool hasNumbers(const scene::FieldInfo& field);
// Returns one number or three. The entity must have the field's component.
std::vector<double> numbersOf(const Session& session, const scene::FieldInfo& field, ecs::Entity entity,
                              const scene::Value& value);
// Returns the value with these numbers, within the field's range.
scene::Value valueOf(const Session& session, const scene::FieldInfo& field, ecs::Entity entity,
                     const std::vector<double>& numbers);
// Returns the step by which the number goes with Ctrl: that of the gizmos where they drag the same.
double stepOf(const Session& session, const scene::FieldInfo& field, double number);

// Answers what inspectors ask about fields: which of them mean something, and what a widget or typed text
// does to a number, so that the same can be done to that number of each selected entity.

// Returns whether a field means something with the component's present values: a point light has no radius,
// and only a spot light has cones. Inspectors leave the others out; files and scripts have all fields. The
// entity must have the field's component.
bool isUsed(const ecs::Registry& registry, ecs::Entity entity, const scene::FieldInfo& field);

// Sets a number, shifts it, or scales it. Of typed text, "6" sets 6, "+=1" shifts by 1, "*2" and "/=4" scale.
struct NumberEdit {
  enum class Kind : std::uint8_t { Set, Add, Multiply };
  Kind kind = Kind::Set;
  double amount = 0.0;

  double appliedTo(double number) const;
};

// Returns nothing if the text is none of these with a finite number.
std::optional<NumberEdit> parseNumberEdit(std::string_view text);

}  // namespace lambent::editor
