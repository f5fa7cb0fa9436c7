// Lists the entities of a registry as the flat rows of a tree, so that a list clipper can draw only the
// visible ones. Nodes are ordered by Transform::parent and bundles by their roots; entities without a place
// (lamps, volumes, materials, animations) stand below their node or bundle. Draws and rigid groups, which
// cannot be edited, have no rows. Rows are rebuilt when treeVersion() has changed. A filter keeps matching
// rows and their ancestors.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/document.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::editor {

struct TreeRow {
  ecs::Entity entity;
  StableId id;
  std::uint32_t depth = 0;
  std::string name;
  // One of the words bundle, node, light, lamp, camera, volume, animation, material, environment and entity;
  // the icon depends on it.
  std::string_view kind;
  bool has_children = false;
  bool open = true;
  bool matches = true;  // false: shown only because a descendant matches
};

struct TreeQuery {
  // A row has to match all words: "ball" (part of the name, in any case), "type:light" (its kind), "has:Lamp"
  // (a component), "id:0123" (a prefix of its id), "-type:node" (not this kind). "two words" in quotes count
  // as one.
  std::string filter;
  std::set<StableId> closed;  // rows whose children are hidden; a filter shows them anyway
  bool operator==(const TreeQuery&) const = default;
};

std::vector<TreeRow> treeRows(const Document& document, const TreeQuery& query);
// Returns a number that changes whenever rows may have changed, but not when entities merely move. It visits
// all Transforms.
std::uint64_t treeVersion(const ecs::Registry& registry);

// Caches the rows of a query and rebuilds them only when the query or the tree has changed.
class TreeRows {
 public:
  TreeQuery query;
  // Returns the rows of the query. They are valid until the next call.
  const std::vector<TreeRow>& of(const Document& document);

 private:
  std::vector<TreeRow> rows_;
  TreeQuery made_by_;
  std::uint64_t made_of_ = ~std::uint64_t{0};  // treeVersion() of rows_
};

// Holds the selected entities as StableIds, in the order in which they were selected. The last is the primary
// one, which panels show and gizmos use. An id whose entity does not exist at present (its bundle is being
// reloaded, or undo removed it) stays and counts again once the entity is back. It does not change the
// registry.

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

// Returns a box around the selection in world space: the bounds of draws and volumes, and a small box around
// an entity that only has a position. The box is empty if nothing selected has a position.
scene::Box selectionBounds(const Document& document, const Selection& selection);

// A box that is turned with what it encloses.
struct TurnedBox {
  glm::mat4 world_from_box{1.0f};
  scene::Box box;
};
// Returns a box around each selected entity, in the frame of its node.
std::vector<TurnedBox> selectionBoxes(const Document& document, const Selection& selection);

}  // namespace lambent::editor
