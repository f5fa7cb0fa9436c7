// Holds what a person has changed, as values: those fields of bundles' entities that differ from the
// baseline, and all fields of Created entities. World files store overrides; the reload of a bundle saves
// and restores them. They are sorted by id, so equal documents have equal overrides.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "editor/document/document.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

struct BaselineBundle {
  const bundle::Description* description = nullptr;
  std::string id;
  std::uint32_t instance = 0;
};

// Keeps the state of a world's bundles before any edit: it creates their entities a second time in a
// registry of its own and finds them by StableId. "Reset to default" returns to it. It is built from the
// bundles' descriptions and must be rebuilt when they change.
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

struct FieldOverride {
  const scene::FieldInfo* field = nullptr;
  scene::Value value;
};

struct EntityOverride {
  StableId id;
  bool created = false;
  std::string name;                // of the entity, for people who read the file
  std::optional<StableId> parent;  // kNoId: the world. None: as in the baseline
  // The components of a Created entity (also those without fields), and fields in the order of the component
  // table.
  std::vector<const scene::ComponentInfo*> components;
  std::vector<FieldOverride> fields;
};

using Overrides = std::vector<EntityOverride>;

// Adopts entities without an id, then returns the overrides of the document.
Overrides captureOverrides(Document& document, const Baseline& baseline);

struct ApplyReport {
  std::vector<std::string> missing;  // entities and components that do not exist, by name and id
};

// Sets the fields, creates the Created entities that do not exist, then sets the parents. What a bundle no
// longer has (its file may have changed) is skipped and reported. Values are not checked again: the reader of
// the file has done so.
ApplyReport applyOverrides(Document& document, const Overrides& overrides);

}  // namespace lambent::editor
