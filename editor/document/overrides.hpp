// Holds what a person has changed, as values: the fields of bundles' entities that differ from the baseline,
// and all of what was created. World files take overrides out of a document and put them back; so does the
// reload of a bundle, whose entities go and come back. They are sorted by id, so that two of the same
// document are equal.
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
  std::string name;                // for readers of the file; of the bundle's entity or its own
  std::optional<StableId> parent;  // kNoId: the world. None: the baseline's
  // Components that a Created entity has (those without fields too), and fields in the table's order.
  std::vector<const scene::ComponentInfo*> components;
  std::vector<FieldOverride> fields;
  UnknownFields unknown;  // "Component", "Component/field" and others, as JSON text
};

using Overrides = std::vector<EntityOverride>;

// Returns the overrides of the document, after it has adopted entities without an id.
Overrides captureOverrides(Document& document, const Baseline& baseline);

struct ApplyReport {
  std::vector<std::string> missing;  // entities and components that are not there, by name and id
};

// Sets the fields and makes the Created entities that are not there, then hangs all where they belong. What
// bundles do not have any more is passed over and reported: their files may have changed since. Values were
// checked when they were read.
ApplyReport applyOverrides(Document& document, const Overrides& overrides);

// ---- a bundle that is closed and opened again (World::replace keeps edits itself): keep = keepForReload(),
// then close and open, by undo of its removal too, then restoreAfterReload(). Selection and history need
// nothing.
struct Kept {
  Overrides overrides;
};
Kept keepForReload(Document& document, const Baseline& before);
ApplyReport restoreAfterReload(Document& document, const Kept& kept);

}  // namespace lambent::editor
