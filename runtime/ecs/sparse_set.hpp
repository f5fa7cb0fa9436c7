// A SparseSet holds the components of one type. Values are packed without gaps, in an order that removal
// changes, and a table maps an entity's index to its place (4 bytes per index ever used). Look-up, insertion
// and removal take constant time.
//
// Every change gives the set a new version and stores it for the entity. So a pass sees with one comparison
// whether anything changed since it last ran, and can then find out which entities. References to values are
// valid until the next insertion or removal.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "runtime/ecs/entity.hpp"

namespace lambent::ecs {

// Owns the part of a set that does not depend on the component's type.
class SparseSetBase {
 public:
  virtual ~SparseSetBase() = default;

  // Returns false if the entity had no component.
  virtual bool remove(Entity entity) = 0;

  bool contains(Entity entity) const { return placeOf(entity) != kNoPlace; }
  std::size_t size() const { return entities_.size(); }
  std::span<const Entity> entities() const { return entities_; }

  // Returns a number that rises with every insertion, removal and touch; it is 0 before the first.
  std::uint64_t version() const { return version_; }
  // Returns the set's version when this entity's component last changed, or 0 if it has none.
  std::uint64_t versionOf(Entity entity) const {
    const std::uint32_t place = placeOf(entity);
    return place == kNoPlace ? 0 : versions_[place];
  }
  void touch(Entity entity) {
    const std::uint32_t place = placeOf(entity);
    assert(place != kNoPlace && "the entity has no such component");
    versions_[place] = ++version_;
  }

 protected:
  static constexpr std::uint32_t kNoPlace = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t placeOf(Entity entity) const {
    if (entity.index >= places_.size()) return kNoPlace;
    const std::uint32_t place = places_[entity.index];
    return place != kNoPlace && entities_[place] == entity ? place : kNoPlace;
  }

  void append(Entity entity);
  // Moves the last entity into the gap. The caller must do the same with the values.
  void removeAt(std::uint32_t place);

 private:
  std::vector<std::uint32_t> places_;    // indexed by Entity::index
  std::vector<Entity> entities_;         // by place
  std::vector<std::uint64_t> versions_;  // by place
  std::uint64_t version_ = 0;
};

template <class T>
class SparseSet final : public SparseSetBase {
  static_assert(std::is_object_v<T> && !std::is_const_v<T> && std::is_move_assignable_v<T>);
  static_assert(!std::is_same_v<T, bool>, "std::vector<bool> hands out no references; wrap it in a struct");

 public:
  // Adds or replaces the entity's value.
  template <class... Args>
  T& emplace(Entity entity, Args&&... args) {
    // Aggregates are initialised with braces, so components need no constructors.
    T value = [&] {
      if constexpr (std::is_constructible_v<T, Args...>) {
        return T(std::forward<Args>(args)...);
      } else {
        return T{std::forward<Args>(args)...};
      }
    }();
    if (const std::uint32_t place = placeOf(entity); place != kNoPlace) {
      touch(entity);
      return values_[place] = std::move(value);
    }
    values_.push_back(std::move(value));
    append(entity);
    return values_.back();
  }

  bool remove(Entity entity) override {
    const std::uint32_t place = placeOf(entity);
    if (place == kNoPlace) return false;
    if (place + 1 != values_.size()) values_[place] = std::move(values_.back());
    values_.pop_back();
    removeAt(place);
    return true;
  }

  T* find(Entity entity) {
    const std::uint32_t place = placeOf(entity);
    return place == kNoPlace ? nullptr : &values_[place];
  }
  const T* find(Entity entity) const {
    const std::uint32_t place = placeOf(entity);
    return place == kNoPlace ? nullptr : &values_[place];
  }

 private:
  std::vector<T> values_;  // by place
};

}  // namespace lambent::ecs
