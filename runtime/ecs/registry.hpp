// A Registry owns entities and their components, with one set per component type that is made on first use. A
// component is any movable struct. Types need no registration, nothing is global, and registries share
// nothing. Systems are functions that take a registry; state<T>() holds what they keep between runs.
//
// There are change counters instead of observers. emplace, remove, touch and edit raise the component's
// version<T>(), and a pass runs if a version is not the one it saw last. get() of a non-const registry
// returns a reference without counting, so code that writes through it must call touch(), or use edit(). Only
// one thread may use a registry at a time. Misuse asserts: adding a component to a dead entity, or get() of a
// missing one.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <tuple>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace lambent::ecs {

// An Entity is a handle: an index, which is reused after destruction, and a generation, which is not. So a
// stale handle is detected instead of meaning another entity. Handles are valid in the registry that made
// them. Data that outlives a session (world files, undo) uses scene::StableId instead.
struct Entity {
  static constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t index = kNoIndex;
  std::uint32_t generation = 0;  // odd while the entity lives; 0 belongs to no entity

  // Returns false for Entity{}, which means "none". If it returns true, the handle may still be stale, which
  // Registry::alive tells.
  explicit operator bool() const { return index != kNoIndex; }
  auto operator<=>(const Entity&) const = default;
};

// A SparseSet holds the components of one type. Values are packed without gaps, in an order that removal
// changes, and a table maps an entity's index to its place (4 bytes per index ever used). Look-up, insertion
// and removal take constant time.
//
// Every change gives the set a new version and stores it for the entity. So a pass sees with one comparison
// whether anything changed since it last ran, and can then find out which entities. References to values are
// valid until the next insertion or removal.

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

// A View iterates over the entities that have all of some components:
//   for (auto [entity, transform, draw] : registry.view<Transform, const DrawItem>()) ...
//
// The loop may create, destroy, add and remove anything. It walks a list of entities that was copied from the
// smallest set when the view was made. It visits an entity once, if it still has every component when its
// turn comes, and does not visit entities that were added meanwhile. (Walking the set itself would skip or
// repeat entities, since removal moves them.) References are valid until the loop body adds or removes a
// component of that type.
template <class... Ts>
class View {
  static_assert(sizeof...(Ts) > 0);
  // A const T needs a const set.
  template <class T>
  using SetOf = std::conditional_t<std::is_const_v<T>, const SparseSet<std::remove_const_t<T>>, SparseSet<T>>;

 public:
  // A set is null if no entity ever had the component. The view is then empty.
  explicit View(SetOf<Ts>*... sets) : sets_(sets...) {
    const std::array<const SparseSetBase*, sizeof...(Ts)> all{sets...};
    if (std::find(all.begin(), all.end(), nullptr) != all.end()) return;
    const SparseSetBase* smallest = *std::min_element(
        all.begin(), all.end(), [](const auto* a, const auto* b) { return a->size() < b->size(); });
    entities_.assign(smallest->entities().begin(), smallest->entities().end());
  }

  class Iterator {
   public:
    Iterator(const View& view, std::size_t at) : view_(&view), at_(at) { settle(); }
    std::tuple<Entity, Ts&...> operator*() const {
      return std::apply(
          [&](auto*... values) { return std::tuple<Entity, Ts&...>(view_->entities_[at_], *values...); },
          found_);
    }
    Iterator& operator++() {
      ++at_;
      settle();
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    // Moves from at_ to the next entity that has all components.
    void settle() {
      for (; at_ < view_->entities_.size(); ++at_) {
        const Entity entity = view_->entities_[at_];
        found_ = std::apply([&](auto*... sets) { return std::tuple<Ts*...>(sets->find(entity)...); },
                            view_->sets_);
        if (std::apply([](auto*... values) { return (... && (values != nullptr)); }, found_)) return;
      }
    }

    const View* view_;
    std::size_t at_;
    std::tuple<Ts*...> found_;
  };

  Iterator begin() const { return Iterator(*this, 0); }
  Iterator end() const { return Iterator(*this, entities_.size()); }

 private:
  std::tuple<SetOf<Ts>*...> sets_;
  std::vector<Entity> entities_;
};

// A type is identified by the address of its own constant, so there is no counter and no name can collide.
template <class T>
inline constexpr char kTypeTag = 0;

class Registry {
 public:
  Entity create();
  // Destroys the entity and its components. Does nothing and returns false if it is not alive.
  bool destroy(Entity entity);
  bool alive(Entity entity) const;
  // Returns all living entities, sorted by index.
  std::vector<Entity> entities() const;

  // Adds or replaces a component.
  template <class T, class... Args>
  T& emplace(Entity entity, Args&&... args) {
    assert(alive(entity) && "a component for an entity that is not alive");
    return setOf<T>().emplace(entity, std::forward<Args>(args)...);
  }
  // Returns false if the entity had no such component.
  template <class T>
  bool remove(Entity entity) {
    SparseSet<T>* set = find<T>();
    return set && set->remove(entity);
  }
  template <class T>
  bool has(Entity entity) const {
    const SparseSet<T>* set = find<T>();
    return set && set->contains(entity);
  }
  // Returns null if the entity is stale or has no such component.
  template <class T>
  T* tryGet(Entity entity) {
    SparseSet<T>* set = find<T>();
    return set ? set->find(entity) : nullptr;
  }
  template <class T>
  const T* tryGet(Entity entity) const {
    const SparseSet<T>* set = find<T>();
    return set ? set->find(entity) : nullptr;
  }
  template <class T>
  T& get(Entity entity) {
    T* value = tryGet<T>(entity);
    assert(value && "the entity has no such component");
    return *value;
  }
  template <class T>
  const T& get(Entity entity) const {
    const T* value = tryGet<T>(entity);
    assert(value && "the entity has no such component");
    return *value;
  }

  // Records that the component was changed through a reference.
  template <class T>
  void touch(Entity entity) {
    setOf<T>().touch(entity);
  }
  // Calls touch() and returns a reference for writing.
  template <class T>
  T& edit(Entity entity) {
    touch<T>(entity);
    return get<T>(entity);
  }

  // Returns the version of all components of the type. It rises with every change, and is 0 if there never
  // was one.
  template <class T>
  std::uint64_t version() const {
    const SparseSet<T>* set = find<T>();
    return set ? set->version() : 0;
  }
  // Returns version<T>() at the last change of this component, or 0 if the entity has none.
  template <class T>
  std::uint64_t version(Entity entity) const {
    const SparseSet<T>* set = find<T>();
    return set ? set->versionOf(entity) : 0;
  }
  template <class T>
  std::size_t count() const {
    const SparseSet<T>* set = find<T>();
    return set ? set->size() : 0;
  }

  // Returns a view of the entities that have all these components. `const T` gives const
  // references.
  template <class... Ts>
  View<Ts...> view() {
    return View<Ts...>(find<std::remove_const_t<Ts>>()...);
  }
  template <class... Ts>
  View<const Ts...> view() const {
    return View<const Ts...>(find<std::remove_const_t<Ts>>()...);
  }

  // Returns the only T of this registry, which is default-constructed on first use.
  template <class T>
  T& state() {
    std::shared_ptr<void>& slot = states_[&kTypeTag<T>];
    if (!slot) slot = std::make_shared<T>();
    return *static_cast<T*>(slot.get());
  }

 private:
  template <class T>
  SparseSet<T>* find() {
    return static_cast<SparseSet<T>*>(findSet(&kTypeTag<T>));
  }
  template <class T>
  const SparseSet<T>* find() const {
    return static_cast<const SparseSet<T>*>(findSet(&kTypeTag<T>));
  }
  template <class T>
  SparseSet<T>& setOf() {
    if (SparseSet<T>* set = find<T>()) return *set;
    auto made = std::make_unique<SparseSet<T>>();
    SparseSet<T>& set = *made;
    addSet(&kTypeTag<T>, std::move(made));
    return set;
  }
  // These are not in the header, so that the map's code is not compiled once per component type.
  SparseSetBase* findSet(const void* type) const;
  void addSet(const void* type, std::unique_ptr<SparseSetBase> set);

  std::vector<std::uint32_t> generations_;  // one per index; odd if alive
  std::vector<std::uint32_t> free_;         // indices to reuse; the last one is used first
  std::unordered_map<const void*, std::unique_ptr<SparseSetBase>> sets_;
  std::unordered_map<const void*, std::shared_ptr<void>> states_;
};

}  // namespace lambent::ecs
