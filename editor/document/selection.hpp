// Holds what is selected, by StableId: several entities in the order in which they were picked, the last of
// them the primary one, about which panels and gizmos speak. Ids that are not there now (their bundle is
// being loaded again, or undo took them) stay and count again when they are back. No registry is changed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "editor/document/document.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::editor {

class Selection {
 public:
  void clear();
  void set(StableId id);                    // it alone
  void set(std::span<const StableId> ids);  // the last is primary
  void add(StableId id);                    // and makes it primary
  void remove(StableId id);
  void toggle(StableId id);  // Ctrl-click
  // Selects, on Shift-click, all from where the last set, add or toggle was to `to`, in the order of `rows`
  // (what the tree shows). Other ids leave the selection.
  void range(std::span<const StableId> rows, StableId to);

  bool contains(StableId id) const;
  bool empty() const { return ids_.empty(); }
  std::span<const StableId> ids() const { return ids_; }
  StableId primary() const { return ids_.empty() ? kNoId : ids_.back(); }
  // Returns those that are there now, the primary last.
  std::vector<ecs::Entity> entities(const Document& document) const;
  ecs::Entity primaryEntity(const Document& document) const;
  // Returns them without those that hang below others of the selection: what a gizmo moves.
  std::vector<ecs::Entity> topmost(const Document& document) const;
  // Forgets those that are not there.
  void prune(const Document& document);
  // Rises with every change.
  std::uint64_t version() const { return version_; }

 private:
  std::vector<StableId> ids_;
  StableId anchor_ = kNoId;
  std::uint64_t version_ = 0;
};

// Returns a box around what is selected, in world space: bounds of draws and groups, and a small box around
// what has only a place. It is empty where nothing of that is selected.
scene::Box selectionBounds(const Document& document, const Selection& selection);

}  // namespace lambent::editor
