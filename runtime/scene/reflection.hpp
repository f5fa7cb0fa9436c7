// All described components of a scene as rows of a table, without their types: what inspectors, undo, world
// files, scripts and the clipboard are written against. A row knows the component's name and fields (name,
// unit, kind, range, default) and reads and writes them in a registry by value. What goes in is checked:
// kinds, ranges, NaN; errors name the field and nothing has changed then. Writing raises versions as
// Registry::edit does. One thread at a time per registry; the table itself is constant. A new component is
// one line in reflection.cpp.
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

// A value of an enum, as files call it.
struct Word {
  std::string text;
  bool operator==(const Word&) const = default;
};

using Value = std::variant<bool, std::int32_t, float, glm::vec3, glm::quat, std::string, Word>;

// In the order of Value's alternatives.
enum class ValueKind : std::uint8_t { Flag, Whole, Number, Vector, Rotation, Text, Word };

inline ValueKind kindOf(const Value& value) {
  return static_cast<ValueKind>(value.index());
}
std::string_view kindWord(ValueKind kind);

// The same bits: tells 0 from -0 and finds NaN equal to itself.
bool sameBits(const Value& a, const Value& b);

// For people: "0.5", "(1, 2, 3)", "point".
std::string valueText(const Value& value);

struct FieldInfo {
  std::string_view component, name, unit;
  ValueKind kind = ValueKind::Flag;
  bool color = false;                       // a Vector that is linear RGB
  std::optional<ecs::Range<float>> range;   // of Whole and Number, both ends included
  std::span<const std::string_view> words;  // of Word: all there are, in the enum's order
  Value default_value;

  // Whether set() would take it.
  Result<void> check(const Value& value) const;

  // The entity has the component.
  Value get(const ecs::Registry& registry, ecs::Entity entity) const { return get_(registry, entity); }
  // Errors: no such component, what check() says.
  Result<void> set(ecs::Registry& registry, ecs::Entity entity, const Value& value) const;
  // As set(), for values that were there before, which may lie outside the range if a file says so: only the
  // kind is checked. False, and nothing happens, if it or the component is another.
  bool restore(ecs::Registry& registry, ecs::Entity entity, const Value& value) const;

  Value (*get_)(const ecs::Registry&, ecs::Entity) = nullptr;
  void (*put_)(ecs::Registry&, ecs::Entity, const Value&) = nullptr;
};

struct ComponentInfo {
  std::string_view name;
  std::span<const FieldInfo> fields;
  bool addable = false;    // by a person, to what a person has made
  bool removable = false;  // likewise

  // Null if there is none of that name.
  const FieldInfo* field(std::string_view field_name) const;

  bool (*has)(const ecs::Registry&, ecs::Entity) = nullptr;
  // With its defaults, or in the place of the one there is.
  void (*add)(ecs::Registry&, ecs::Entity) = nullptr;
  bool (*remove)(ecs::Registry&, ecs::Entity) = nullptr;  // false if there was none
  // All declared fields; the others stay. False, and nothing happens, unless both have the component.
  bool (*copy)(ecs::Registry&, ecs::Entity from, ecs::Entity to) = nullptr;
  // As Registry::version<T>(): of all, and of one.
  std::uint64_t (*version)(const ecs::Registry&) = nullptr;
  std::uint64_t (*versionOf)(const ecs::Registry&, ecs::Entity) = nullptr;
  // The bundle that the component belongs to while the program runs; none for components without.
  std::optional<std::uint32_t> (*bundle)(const ecs::Registry&, ecs::Entity) = nullptr;
};

// In the order in which an inspector shows them.
std::span<const ComponentInfo> components();
// Null if there is none of that name.
const ComponentInfo* findComponent(std::string_view name);
// Errors list what there is.
Result<const FieldInfo*> findField(std::string_view component, std::string_view field);

}  // namespace lambent::scene
