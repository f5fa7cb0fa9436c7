// Lists the entities of a registry as rows of a tree, flat, so that a list clipper can show the few that are
// visible: nodes by Transform::parent, bundles by their roots, and what has no place of its own (draws,
// groups, lamps, materials, animations) below its node, group or bundle. Rows are made again when
// treeVersion() has changed. A filter keeps rows that match and those above them.
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
  std::string_view kind;  // of the icon: bundle, node, light, lamp, camera, draw, group, volume, animation,
                          // material, environment, entity
  bool has_children = false;
  bool open = true;
  bool matches = true;  // false: stands here for what is below it
};

struct TreeQuery {
  // Words that must all hold: "ball" (part of the name, any case), "type:light" (kind), "has:Lamp" (a
  // component), "id:0123" (how the id begins), "-type:draw" (not). "two words" in quotes are one.
  std::string filter;
  std::set<StableId> closed;  // rows whose children are not shown; a filter shows them all the same
  bool show_parts = true;     // draws and groups, which nobody edits
  bool operator==(const TreeQuery&) const = default;
};

std::vector<TreeRow> treeRows(const Document& document, const TreeQuery& query);
// Returns another number whenever rows may be others, but not while things only move. Walks over the
// Transforms.
std::uint64_t treeVersion(const ecs::Registry& registry);

// Keeps the rows of a query, and makes them again only when the query or the tree has changed.
class TreeRows {
 public:
  TreeQuery query;
  // Returns the rows of the query; they are valid until the next call.
  const std::vector<TreeRow>& of(const Document& document);

 private:
  std::vector<TreeRow> rows_;
  TreeQuery made_by_;
  std::uint64_t made_of_ = ~std::uint64_t{0};  // tree version
};

// Returns the word for the kind of an entity.
std::string_view kindWordOf(const ecs::Registry& registry, ecs::Entity entity);

// Matches entities against the text of a filter; other lists use it, too.
class TreeFilter {
 public:
  explicit TreeFilter(std::string_view text);
  bool empty() const { return terms_.empty(); }
  bool matches(const Document& document, ecs::Entity entity, std::string_view name,
               std::string_view kind) const;

 private:
  struct Term {
    enum class Of : std::uint8_t { Name, Kind, Component, Id } of = Of::Name;
    std::string text;  // lower case
    bool negative = false;
  };
  std::vector<Term> terms_;
};

}  // namespace lambent::editor
