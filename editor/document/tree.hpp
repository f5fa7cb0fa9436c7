// Lists the entities of a registry as the flat rows of a tree, so that a list clipper can draw only the
// visible ones. Nodes are ordered by Transform::parent and bundles by their roots; entities without a place
// (draws, groups, lamps, materials, animations) stand below their node, group or bundle. Rows are rebuilt
// when treeVersion() has changed. A filter keeps matching rows and their ancestors.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/document.hpp"

namespace lambent::editor {

struct TreeRow {
  ecs::Entity entity;
  StableId id;
  std::uint32_t depth = 0;
  std::string name;
  // One of the words bundle, node, light, lamp, camera, draw, group, volume, animation, material, environment
  // and entity; the icon depends on it.
  std::string_view kind;
  bool has_children = false;
  bool open = true;
  bool matches = true;  // false: shown only because a descendant matches
};

struct TreeQuery {
  // A row has to match all words: "ball" (part of the name, in any case), "type:light" (its kind), "has:Lamp"
  // (a component), "id:0123" (a prefix of its id), "-type:draw" (not this kind). "two words" in quotes count
  // as one.
  std::string filter;
  std::set<StableId> closed;  // rows whose children are hidden; a filter shows them anyway
  bool show_parts = true;     // whether to list draws and groups, which cannot be edited
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

}  // namespace lambent::editor
