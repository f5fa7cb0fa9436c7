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
// A type is identified by the address of its own constant, so there is no counter and no name can collide.
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
  // Destroys the entity and its components. Does nothing and returns false if it is not alive.
  bool destroy(Entity entity);
  bool alive(Entity entity) const;
  std::size_t entityCount() const { return alive_count_; }
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

  // Returns a view of the entities that have all these components (view.hpp). `const T` gives const
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
  // These are not in the header, so that the map's code is not compiled once per component type.
  SparseSetBase* findSet(detail::TypeId type) const;
  void addSet(detail::TypeId type, std::unique_ptr<SparseSetBase> set);

  std::vector<std::uint32_t> generations_;  // one per index; odd if alive
  std::vector<std::uint32_t> free_;         // indices to reuse; the last one is used first
  std::size_t alive_count_ = 0;
  std::unordered_map<detail::TypeId, std::unique_ptr<SparseSetBase>> sets_;
  std::unordered_map<detail::TypeId, std::shared_ptr<void>> states_;
};

}  // namespace lambent::ecs
