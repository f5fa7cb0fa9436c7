// Knows how a world's bundles stand before anybody edits them: it makes the same entities once more in a
// registry of its own and finds them by StableId. World files keep only what differs from it, and "reset to
// default" goes back to it. It is made of the bundles' descriptions, and must be made again when they change.
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
  // Errors: two bundles of one id and instance.
  static Result<Baseline> create(std::span<const BaselineBundle> bundles);

  const ecs::Registry& registry() const { return registry_; }
  // Returns the entity, or none where it is not of these bundles.
  ecs::Entity find(scene::StableId id) const;
  // Returns the field's value, or none where the bundles have no such entity or component.
  std::optional<scene::Value> value(scene::StableId id, const scene::FieldInfo& field) const;
  scene::StableId parent(scene::StableId id) const;
  // Returns whether an animation moves the node's translation, rotation or scale: then it stands where the
  // animation says, and that is not an edit.
  bool animated(scene::StableId id, std::string_view transform_field) const;

 private:
  ecs::Registry registry_;
  std::unordered_map<std::uint64_t, ecs::Entity> entities_;
  std::unordered_set<std::string> animated_;
};

}  // namespace lambent::editor
