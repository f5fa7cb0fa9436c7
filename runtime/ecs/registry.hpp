// Entities and their components: a set per component type, made when the type is first used. A component is
// any movable struct; nothing is registered beforehand and nothing is global: two registries share nothing.
// Systems are functions over a registry; what one keeps between runs lies in state<T>().
//
// Changes are counted, not observed: emplace, remove, touch and edit give the component's version<T>() a new
// value, and a pass runs when a version is not the one it has seen. get() of a non-const registry hands out a
// reference without counting: whoever writes through it says so with touch(), or uses edit(). One thread at a
// time. Misuse (a component of a dead entity, get() of one that is missing) asserts.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "runtime/ecs/entity.hpp"
#include "runtime/ecs/sparse_set.hpp"
#include "runtime/ecs/view.hpp"

namespace lambent::ecs {

namespace detail {
// A type's identity is the address of a constant of its own: no counter to keep, no names to collide.
template <class T>
inline constexpr char kTypeTag = 0;
using TypeId = const void*;
template <class T>
constexpr TypeId typeId() {
  return &kTypeTag<T>;
}
}  // namespace detail

class Registry {
 public:
  Registry() = default;
  Registry(Registry&&) noexcept = default;
  Registry& operator=(Registry&&) noexcept = default;

  Entity create();
  // Removes its components too. False, and nothing happens, if it is not alive.
  bool destroy(Entity entity);
  bool alive(Entity entity) const;
  std::size_t entityCount() const { return alive_count_; }
  // All that live, by index.
  std::vector<Entity> entities() const;

  // Adds a component, or replaces the one there is.
  template <class T, class... Args>
  T& emplace(Entity entity, Args&&... args) {
    assert(alive(entity) && "a component for an entity that is not alive");
    return setOf<T>().emplace(entity, std::forward<Args>(args)...);
  }
  // False if there was none.
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
  // Null where the entity is stale or has no such component.
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

  // Says that the component was changed through a reference.
  template <class T>
  void touch(Entity entity) {
    setOf<T>().touch(entity);
  }
  // get() and touch(): a reference for writing.
  template <class T>
  T& edit(Entity entity) {
    touch<T>(entity);
    return get<T>(entity);
  }

  // Of all components of the type: rises with every change to any; 0 if there never was one.
  template <class T>
  std::uint64_t version() const {
    const SparseSet<T>* set = find<T>();
    return set ? set->version() : 0;
  }
  // Of one: the version<T>() of its last change; 0 where there is none.
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

  // See view.hpp. `const T` in the list gives const references.
  template <class... Ts>
  View<Ts...> view() {
    return View<Ts...>(find<std::remove_const_t<Ts>>()...);
  }
  template <class... Ts>
  View<const Ts...> view() const {
    return View<const Ts...>(find<std::remove_const_t<Ts>>()...);
  }

  // The one T of this registry, default-constructed on first use.
  template <class T>
  T& state() {
    std::shared_ptr<void>& slot = states_[detail::typeId<T>()];
    if (!slot) slot = std::make_shared<T>();
    return *static_cast<T*>(slot.get());
  }

 private:
  template <class T>
  SparseSet<T>* find() {
    return static_cast<SparseSet<T>*>(findSet(detail::typeId<T>()));
  }
  template <class T>
  const SparseSet<T>* find() const {
    return static_cast<const SparseSet<T>*>(findSet(detail::typeId<T>()));
  }
  template <class T>
  SparseSet<T>& setOf() {
    if (SparseSet<T>* set = find<T>()) return *set;
    auto made = std::make_unique<SparseSet<T>>();
    SparseSet<T>& set = *made;
    addSet(detail::typeId<T>(), std::move(made));
    return set;
  }
  // Not in the header: the map's code once, instead of once per component type.
  SparseSetBase* findSet(detail::TypeId type) const;
  void addSet(detail::TypeId type, std::unique_ptr<SparseSetBase> set);

  std::vector<std::uint32_t> generations_;  // by index; odd: alive
  std::vector<std::uint32_t> free_;         // indices to use again, latest first
  std::size_t alive_count_ = 0;
  std::unordered_map<detail::TypeId, std::unique_ptr<SparseSetBase>> sets_;
  std::unordered_map<detail::TypeId, std::shared_ptr<void>> states_;
};

}  // namespace lambent::ecs
