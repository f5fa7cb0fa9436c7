// Holds the selected entities as StableIds, in the order in which they were selected. The last is the primary
// one, which panels show and gizmos use. An id whose entity does not exist at present (its bundle is being
// reloaded, or undo removed it) stays and counts again once the entity is back. It does not change the
// registry.
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
  void set(StableId id);                    // selects this one only
  void set(std::span<const StableId> ids);  // the last becomes primary
  void add(StableId id);                    // makes it primary
  void remove(StableId id);
  void toggle(StableId id);  // as Ctrl-click does
  // Selects as Shift-click does: all of `rows` (the rows of the tree, in order) between the last set, add or
  // toggle and `to`. All other ids are deselected.
  void range(std::span<const StableId> rows, StableId to);

  bool contains(StableId id) const;
  bool empty() const { return ids_.empty(); }
  std::span<const StableId> ids() const { return ids_; }
  StableId primary() const { return ids_.empty() ? kNoId : ids_.back(); }
  // Returns the selected entities that exist at present, the primary last.
  std::vector<ecs::Entity> entities(const Document& document) const;
  ecs::Entity primaryEntity(const Document& document) const;
  // Returns the selected entities without those that have a selected ancestor. These are what a gizmo moves.
  std::vector<ecs::Entity> topmost(const Document& document) const;
  std::uint64_t version() const { return version_; }

 private:
  std::vector<StableId> ids_;
  StableId anchor_ = kNoId;
  std::uint64_t version_ = 0;
};

// Returns a box around the selection in world space: the bounds of draws and groups, and a small box around
// an entity that only has a position. The box is empty if nothing selected has a position.
scene::Box selectionBounds(const Document& document, const Selection& selection);

// A box that is turned with what it encloses.
struct TurnedBox {
  glm::mat4 world_from_box{1.0f};
  scene::Box box;
};
// Returns a box around each selected entity, in the frame of its node or group.
std::vector<TurnedBox> selectionBoxes(const Document& document, const Selection& selection);

}  // namespace lambent::editor
