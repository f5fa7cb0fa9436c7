// Lets a component declare its fields once. The inspector, undo, world files and scripts use that list:
//
//   struct Lamp {
//     float power_cd = 1.0f;
//     static constexpr std::string_view kComponentName = "Lamp";
//     static constexpr auto fields() {
//       return std::tuple{ecs::Field{"power", &Lamp::power_cd, 1.0f, "cd", ecs::Range{0.0f, 1000.0f}}};
//     }
//   };
//
// Values that a system derives (matrices, caches) are not declared. Units are words such as "m" or "deg", or
// "" for none.
#pragma once

#include <concepts>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

namespace lambent::ecs {

// Gives the smallest and the largest sensible value.
template <class T>
struct Range {
  T least, greatest;
};
template <class T>
Range(T, T) -> Range<T>;  // Clang 16 deduces no arguments of aggregates

template <class Owner, class T>
struct Field {
  using Value = T;

  std::string_view name;  // name in files and scripts, in lower_snake_case; it must not change
  T Owner::*member;
  T default_value{};
  std::string_view unit{};
  std::optional<Range<T>> range{};

  constexpr Field(std::string_view field_name, T Owner::*field_member, std::type_identity_t<T> field_default,
                  std::string_view field_unit = {},
                  std::optional<Range<std::type_identity_t<T>>> field_range = {})
      : name(field_name),
        member(field_member),
        default_value(std::move(field_default)),
        unit(field_unit),
        range(field_range) {}

  constexpr T& of(Owner& owner) const { return owner.*member; }
  constexpr const T& of(const Owner& owner) const { return owner.*member; }
};

template <class T>
concept Described = requires {
  { T::kComponentName } -> std::convertible_to<std::string_view>;
  T::fields();
};

// Calls visitor(field, value) for each field in the order of declaration. The value is const if the component
// is.
template <class Component, class Visitor>
requires Described<std::remove_const_t<Component>>
constexpr void forEachField(Component& component, Visitor&& visitor) {
  std::apply([&](const auto&... field) { (visitor(field, field.of(component)), ...); }, component.fields());
}

// Returns whether the value is in the field's range, if it declares one. NaN is outside every range.
template <class Owner, class T>
constexpr bool withinRange(const Field<Owner, T>& field, const T& value) {
  if constexpr (std::totally_ordered<T>) {
    return !field.range || (value >= field.range->least && value <= field.range->greatest);
  } else {
    return true;
  }
}

}  // namespace lambent::ecs
