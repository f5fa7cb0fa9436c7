// Keeps the state of a world's bundles before any edit: it creates their entities a second time in a registry
// of its own and finds them by StableId. World files store only what differs from this state, and "reset to
// default" returns to it. It is built from the bundles' descriptions and must be rebuilt when they change.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/reflection.hpp"
#include "runtime/scene/stable_id.hpp"

namespace lambent::editor {

struct BaselineBundle {
  const bundle::Description* description = nullptr;
  std::string id;
  std::uint32_t instance = 0;
};

class Baseline {
 public:
  Baseline() = default;
  // Errors: two bundles have the same id and instance.
  static Result<Baseline> create(std::span<const BaselineBundle> bundles);

  const ecs::Registry& registry() const { return registry_; }
  // Returns the entity, or none if it does not belong to these bundles.
  ecs::Entity find(scene::StableId id) const;
  // Returns the field's value, or none if the bundles have no such entity or component.
  std::optional<scene::Value> value(scene::StableId id, const scene::FieldInfo& field) const;
  scene::StableId parent(scene::StableId id) const;
  // Returns whether an animation drives this field of the node's Transform (translation, rotation or scale).
  // A difference in such a field is not an edit.
  bool animated(scene::StableId id, std::string_view transform_field) const;

 private:
  ecs::Registry registry_;
  std::unordered_map<std::uint64_t, ecs::Entity> entities_;
  std::unordered_set<std::string> animated_;
};

}  // namespace lambent::editor
