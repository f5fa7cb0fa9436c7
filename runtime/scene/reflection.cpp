#include "runtime/scene/reflection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "runtime/base/finite.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::scene {
namespace {

// ---- conversion between values and members

template <class T>
Value toValue(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    const auto words = enumWords(value);
    const auto at = static_cast<std::size_t>(value);
    return Word{at < words.size() ? std::string(words[at]) : std::to_string(at)};
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    return static_cast<std::int32_t>(value);
  } else {
    return value;
  }
}

// Assigns a value of the member's kind. A Word must be one of the enum's names.
template <class T>
void fromValue(T& member, const Value& value) {
  if constexpr (std::is_enum_v<T>) {
    const auto words = enumWords(member);
    const auto found = std::find(words.begin(), words.end(), std::get<Word>(value).text);
    if (found != words.end()) member = static_cast<T>(found - words.begin());
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    member = static_cast<T>(std::get<std::int32_t>(value));
  } else {
    member = std::get<T>(value);
  }
}

// ---- rows

template <class C, std::size_t I>
FieldInfo fieldInfo() {
  const auto fields = C::fields();
  const auto& field = std::get<I>(fields);
  using T = typename std::remove_cvref_t<decltype(field)>::Value;
  FieldInfo info;
  info.component = C::kComponentName;
  info.name = field.name;
  info.unit = field.unit;
  info.default_value = toValue(field.default_value);
  info.kind = kindOf(info.default_value);
  info.color = info.kind == ValueKind::Vector && (field.name.ends_with("color") || field.name == "emission");
  if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
    if (field.range)
      info.range = ecs::Range<float>{static_cast<float>(field.range->least),
                                     static_cast<float>(field.range->greatest)};
  }
  if constexpr (std::is_enum_v<T>) info.words = enumWords(field.default_value);
  info.get_ = [](const ecs::Registry& registry, ecs::Entity entity) {
    return toValue(std::get<I>(C::fields()).of(registry.get<C>(entity)));
  };
  info.put_ = [](ecs::Registry& registry, ecs::Entity entity, const Value& value) {
    fromValue(std::get<I>(C::fields()).of(registry.edit<C>(entity)), value);
  };
  return info;
}

template <ecs::Described C>
std::span<const FieldInfo> fieldInfos() {
  static const auto infos = []<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<FieldInfo, sizeof...(I)>{fieldInfo<C, I>()...};
  }
  (std::make_index_sequence<std::tuple_size_v<decltype(C::fields())>>{});
  return infos;
}

enum class By : std::uint8_t {
  File,        // a bundle or the program adds and removes it
  Person,      // users add and remove it
  Everything,  // every entity that a user makes has it
};

template <ecs::Described C>
ComponentInfo row(By by) {
  ComponentInfo info;
  info.name = C::kComponentName;
  info.fields = fieldInfos<C>();
  info.addable = by != By::File;
  info.removable = by == By::Person;
  info.has = [](const ecs::Registry& registry, ecs::Entity entity) { return registry.has<C>(entity); };
  info.add = [](ecs::Registry& registry, ecs::Entity entity) { registry.emplace<C>(entity); };
  info.remove = [](ecs::Registry& registry, ecs::Entity entity) { return registry.remove<C>(entity); };
  info.copy = [](ecs::Registry& registry, ecs::Entity from, ecs::Entity to) {
    if (!registry.has<C>(from) || !registry.has<C>(to)) return false;
    const C& source = registry.get<C>(from);
    C& target = registry.edit<C>(to);
    ecs::forEachField(target, [&](const auto& field, auto& value) { value = field.of(source); });
    return true;
  };
  info.bundle = [](const ecs::Registry& registry, ecs::Entity entity) -> std::optional<std::uint32_t> {
    if constexpr (requires(const C& c) { std::uint32_t{c.bundle}; }) {
      if (const C* component = registry.tryGet<C>(entity)) return component->bundle;
    }
    return std::nullopt;
  };
  return info;
}

}  // namespace

std::span<const ComponentInfo> components() {
  // THE list: every part of the program knows a component with fields once it is in this list.
  static const std::array kComponents{
      row<Name>(By::Everything),
      row<Transform>(By::Everything),
      row<LocalLightComponent>(By::Person),
      row<LampComponent>(By::File),
      row<MaterialComponent>(By::File),
      row<CameraComponent>(By::Person),
      row<AnimationComponent>(By::File),
      row<EnvironmentComponent>(By::File),
  };
  return kComponents;
}

std::string_view kindWord(ValueKind kind) {
  constexpr std::string_view kWords[] = {"true or false", "a whole number", "a number", "three numbers",
                                         "a rotation",    "a text",         "a word"};
  return kWords[static_cast<std::size_t>(kind)];
}

bool sameBits(const Value& a, const Value& b) {
  if (a.index() != b.index()) return false;
  return std::visit(
      [&]<class T>(const T& left) {
        const T& right = std::get<T>(b);
        if constexpr (std::is_trivially_copyable_v<T>)
          return std::memcmp(&left, &right, sizeof(T)) == 0;
        else
          return left == right;
      },
      a);
}

std::string valueText(const Value& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::remove_cvref_t<decltype(v)>;
        if constexpr (std::is_same_v<T, glm::vec3>) {
          return fmt::format("({}, {}, {})", v.x, v.y, v.z);
        } else if constexpr (std::is_same_v<T, glm::quat>) {
          return fmt::format("({}, {}, {}, {})", v.x, v.y, v.z, v.w);
        } else if constexpr (std::is_same_v<T, Word>) {
          return v.text;
        } else {
          return fmt::format("{}", v);
        }
      },
      value);
}

Result<void> FieldInfo::check(const Value& value) const {
  const auto wrong = [&](std::string problem, std::string hint) {
    return fail(fmt::format("{}.{}", component, name), std::move(problem), std::move(hint));
  };
  if (kindOf(value) != kind)
    return wrong(fmt::format("takes {}, not {}", kindWord(kind), kindWord(kindOf(value))), "");
  switch (kind) {
    case ValueKind::Whole:
    case ValueKind::Number: {
      const auto* whole = std::get_if<std::int32_t>(&value);
      const float number = whole ? static_cast<float>(*whole) : std::get<float>(value);
      if (!std::isfinite(number)) return wrong("is not a finite number", "");
      if (range && !(number >= range->least && number <= range->greatest))
        return wrong(fmt::format("{} lies outside {}..{}", valueText(value), range->least, range->greatest),
                     "");
      return {};
    }
    case ValueKind::Vector: {
      const glm::vec3 v = std::get<glm::vec3>(value);
      if (!isFinite(v)) return wrong("is not finite", "give three finite numbers");
      if (color && (v.x < 0.0f || v.y < 0.0f || v.z < 0.0f))
        return wrong(fmt::format("{} is a color with a negative part", valueText(value)), "");
      return {};
    }
    case ValueKind::Rotation: {
      const float length = glm::length(std::get<glm::quat>(value));
      // A length far from 1 is a mistake. A length near 1 is rounding, which does no harm.
      if (!(std::abs(length - 1.0f) <= 1e-3f))
        return wrong(fmt::format("is no rotation: its length is {}", length), "give a unit quaternion");
      return {};
    }
    case ValueKind::Word: {
      const std::string& text = std::get<Word>(value).text;
      if (std::ranges::find(words, text) != words.end()) return {};
      return wrong(fmt::format("knows no \"{}\"", text), fmt::format("use {}", fmt::join(words, ", ")));
    }
    case ValueKind::Flag:
    case ValueKind::Text:
      return {};
  }
  return {};
}

Result<void> FieldInfo::set(ecs::Registry& registry, ecs::Entity entity, const Value& value) const {
  const ComponentInfo* owner = findComponent(component);
  if (!owner || !owner->has(registry, entity))
    return fail(fmt::format("{}.{}", component, name), fmt::format("the entity has no {}", component));
  if (const Result<void> good = check(value); !good) return good;
  put_(registry, entity, value);
  return {};
}

bool FieldInfo::restore(ecs::Registry& registry, ecs::Entity entity, const Value& value) const {
  const ComponentInfo* owner = findComponent(component);
  if (kindOf(value) != kind || !owner || !owner->has(registry, entity)) return false;
  put_(registry, entity, value);
  return true;
}

const FieldInfo* ComponentInfo::field(std::string_view field_name) const {
  const auto found = std::ranges::find(fields, field_name, &FieldInfo::name);
  return found == fields.end() ? nullptr : &*found;
}

const ComponentInfo* findComponent(std::string_view name) {
  const auto all = components();
  const auto found = std::ranges::find(all, name, &ComponentInfo::name);
  return found == all.end() ? nullptr : &*found;
}

Result<const FieldInfo*> findField(std::string_view component, std::string_view field) {
  const auto list = [](auto items) {
    std::string text;
    for (const auto& item : items) text += (text.empty() ? "use " : ", ") + std::string(item.name);
    return text;
  };
  const ComponentInfo* owner = findComponent(component);
  if (!owner) return fail(fmt::format("component \"{}\"", component), "is not known", list(components()));
  if (const FieldInfo* info = owner->field(field)) return info;
  return fail(fmt::format("{}.{}", component, field), "there is no such field", list(owner->fields));
}

}  // namespace lambent::scene
