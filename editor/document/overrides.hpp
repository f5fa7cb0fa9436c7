// Holds what a person has changed, as values: those fields of bundles' entities that differ from the
// baseline, and all fields of Created entities. World files store overrides; the reload of a bundle saves and
// restores them. They are sorted by id, so equal documents have equal overrides.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "editor/document/baseline.hpp"
#include "editor/document/document.hpp"
#include "runtime/base/result.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

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
  UnknownFields unknown;  // by "Component", "Component/field" or another key, as JSON text
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
