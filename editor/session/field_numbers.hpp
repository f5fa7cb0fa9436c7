// Converts values of fields to the numbers that an artist reads and drags, and back: angles in degrees,
// rotations as angles about x, y and z, the strength of lights in the chosen unit. It also says which fields
// mean something.
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

// Holds the angles that a field gave a rotation. Many angles give one rotation, so a field that made them
// anew from the rotation in each frame would jump to others while it is dragged beyond 90 degrees.
struct HeldAngles {
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 degrees{0.0f};
};

bool isStrengthOfLight(const scene::FieldInfo& field);
// Returns whether the field is a number or three. Whole numbers are choices (of a measured BRDF).
bool hasNumbers(const scene::FieldInfo& field);
// Returns one number or three. The entity must have the field's component.
std::vector<double> numbersOf(const Session& session, const scene::FieldInfo& field, ecs::Entity entity,
                              const scene::Value& value);
// Returns the value with these numbers, within the field's range.
scene::Value valueOf(const Session& session, const scene::FieldInfo& field, ecs::Entity entity,
                     const std::vector<double>& numbers);
// Returns whether a field means something with the component's present values: a point light has no radius,
// and only a spot light has cones. Inspectors leave the others out; files and scripts have all fields. The
// entity must have the field's component.
bool isUsed(const ecs::Registry& registry, ecs::Entity entity, const scene::FieldInfo& field);

}  // namespace lambent::editor
