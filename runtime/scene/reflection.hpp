// Lists all described components of a scene in a table, without their types. The inspector, undo, world
// files, scripts and the clipboard use it. A row has the component's name and fields (name, unit, kind,
// range, default), and reads and writes their values in a registry. Written values are checked for kind,
// range and NaN; an error names the field, and nothing has changed. Writing raises versions as Registry::edit
// does. Only one thread may use a registry at a time; the table itself is constant. To add a component, add a
// line in reflection.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/ecs/fields.hpp"
#include "runtime/ecs/registry.hpp"

namespace lambent::scene {

// Holds the name of an enum's value in files.
struct Word {
  std::string text;
  bool operator==(const Word&) const = default;
};

using Value = std::variant<bool, std::int32_t, float, glm::vec3, glm::quat, std::string, Word>;

// The kinds are in the order of Value's alternatives.
enum class ValueKind : std::uint8_t { Flag, Whole, Number, Vector, Rotation, Text, Word };

inline ValueKind kindOf(const Value& value) {
  return static_cast<ValueKind>(value.index());
}

// Returns whether the bits are equal, so 0 differs from -0 and NaN equals itself.
bool sameBits(const Value& a, const Value& b);

// Returns a text for users, such as "0.5", "(1, 2, 3)" or "point".
std::string valueText(const Value& value);

struct FieldInfo {
  std::string_view component, name, unit;
  ValueKind kind = ValueKind::Flag;
  bool color = false;                       // true for a Vector that is linear RGB
  std::optional<ecs::Range<float>> range;   // for Whole and Number; both ends are included
  std::span<const std::string_view> words;  // for Word: all names, in the enum's order
  Value default_value;

  // Returns an error if set() would not accept the value.
  Result<void> check(const Value& value) const;

  // Returns the value. The entity must have the component.
  Value (*get)(const ecs::Registry&, ecs::Entity) = nullptr;
  // Fails as check() does, and if the entity does not have the component.
  Result<void> set(ecs::Registry& registry, ecs::Entity entity, const Value& value) const;
  // Sets a value that the field had before. It may be outside the range, since files may contain such values,
  // so only the kind is checked. Does nothing and returns false if the kind differs or the component is
  // missing.
  bool restore(ecs::Registry& registry, ecs::Entity entity, const Value& value) const;

  void (*put_)(ecs::Registry&, ecs::Entity, const Value&) = nullptr;
};

struct ComponentInfo {
  std::string_view name;
  std::span<const FieldInfo> fields;
  bool addable = false;    // true if users may add it to entities that they made
  bool removable = false;  // true if users may remove it from such entities

  // Returns null if there is no field of that name.
  const FieldInfo* field(std::string_view field_name) const;

  bool (*has)(const ecs::Registry&, ecs::Entity) = nullptr;
  // Adds the component with its defaults, or replaces the one there is.
  void (*add)(ecs::Registry&, ecs::Entity) = nullptr;
  bool (*remove)(ecs::Registry&, ecs::Entity) = nullptr;  // returns false if there was none
  // Returns the number of the bundle that the component belongs to, or nothing if it belongs to none.
  std::optional<std::uint32_t> (*bundle)(const ecs::Registry&, ecs::Entity) = nullptr;
};

// Returns all components in the order in which an inspector shows them.
std::span<const ComponentInfo> components();
// Returns null if there is no component of that name.
const ComponentInfo* findComponent(std::string_view name);
// The error lists the components or fields that exist.
Result<const FieldInfo*> findField(std::string_view component, std::string_view field);

}  // namespace lambent::scene
