#include "editor/document/tree.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <map>
#include <sstream>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "runtime/base/lower_case.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

namespace {

// Returns the bundle that an entity belongs to, by its number in the running program.
std::optional<std::uint32_t> bundleOf(const ecs::Registry& registry, ecs::Entity entity) {
  if (const auto* group = registry.tryGet<scene::RigidGroupComponent>(entity)) return group->bundle;
  if (registry.has<Created>(entity)) return std::nullopt;  // a Created camera belongs to no bundle
  for (const scene::ComponentInfo& component : scene::components()) {
    if (const auto bundle = component.bundle(registry, entity)) return bundle;
  }
  return std::nullopt;
}

// Returns the word of TreeRow::kind for an entity.
std::string_view kindWordOf(const ecs::Registry& registry, ecs::Entity entity) {
  if (registry.has<scene::VolumeItem>(entity)) return "volume";
  // The first component that the entity has decides.
  constexpr std::pair<std::string_view, std::string_view> kKinds[] = {
      {"Light", "light"},         {"Lamp", "lamp"},         {"Camera", "camera"},
      {"Animation", "animation"}, {"Material", "material"}, {"Environment", "environment"},
      {"Transform", "node"}};
  for (const auto& [component, kind] : kKinds) {
    const scene::ComponentInfo* info = scene::findComponent(component);
    if (info && info->has(registry, entity)) return kind;
  }
  return "entity";
}

// Matches entities against the text of a filter, as TreeQuery::filter.
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

TreeFilter::TreeFilter(std::string_view text) {
  std::istringstream words{std::string(text)};
  // The last word may have an open quote while it is typed.
  for (std::string word; words >> std::quoted(word) || !word.empty(); word.clear()) {
    Term term;
    if (word.size() > 1 && word.front() == '-') {
      term.negative = true;
      word.erase(0, 1);
    }
    word = lowerCase(word);
    constexpr std::pair<std::string_view, Term::Of> kPrefixes[] = {
        {"type:", Term::Of::Kind}, {"has:", Term::Of::Component}, {"id:", Term::Of::Id}};
    for (const auto& [prefix, of] : kPrefixes) {
      if (!word.starts_with(prefix)) continue;
      term.of = of;
      word.erase(0, prefix.size());
      break;
    }
    term.text = std::move(word);
    if (!term.text.empty()) terms_.push_back(std::move(term));
  }
}

bool TreeFilter::matches(const Document& document, ecs::Entity entity, std::string_view name,
                         std::string_view kind) const {
  return std::all_of(terms_.begin(), terms_.end(), [&](const Term& term) {
    const bool holds = [&] {
      switch (term.of) {
        case Term::Of::Name:
          return lowerCase(name).find(term.text) != std::string::npos;
        case Term::Of::Kind:
          return kind == term.text;
        case Term::Of::Id:
          return idText(document.idOf(entity)).starts_with(term.text);
        case Term::Of::Component: {
          const auto all = scene::components();
          return std::any_of(all.begin(), all.end(), [&](const scene::ComponentInfo& row) {
            return lowerCase(row.name) == term.text && row.has(document.registry(), entity);
          });
        }
      }
      return false;
    }();
    return holds != term.negative;
  });
}

class TreeBuilder {
 public:
  TreeBuilder(const Document& document, const TreeQuery& query)
      : document_(document), registry_(document.registry()), query_(query), filter_(query.filter) {}

  std::vector<TreeRow> run() {
    findRoots();
    std::vector<ecs::Entity> tops;
    for (const ecs::Entity entity : registry_.entities()) {
      if (!listed(entity)) continue;
      const ecs::Entity parent = parentRow(entity);
      (parent ? children_[parent.index] : tops).push_back(entity);
    }
    // The tree is walked depth first without recursion, because it may be arbitrarily deep.
    std::vector<std::pair<ecs::Entity, std::uint32_t>> open;
    for (auto top = tops.rbegin(); top != tops.rend(); ++top) open.emplace_back(*top, 0u);
    while (!open.empty()) {
      const auto [entity, depth] = open.back();
      open.pop_back();
      if (!std::exchange(seen_[entity.index], true)) visit(entity, depth, open);
    }
    if (!filter_.empty()) keepMatches();
    return std::move(rows_);
  }

 private:
  bool listed(ecs::Entity entity) const {
    if (registry_.has<scene::DrawItem>(entity)) return false;
    if (registry_.has<scene::RigidGroupComponent>(entity)) return registry_.has<scene::VolumeItem>(entity);
    if (registry_.has<StableId>(entity)) return true;
    const auto all = scene::components();
    return std::any_of(all.begin(), all.end(), [&](const auto& row) { return row.has(registry_, entity); });
  }

  // Finds each bundle's root, and the groups by bundle and number.
  void findRoots() {
    const auto take = [&](std::uint32_t bundle, ecs::Entity node) {
      // The root is the topmost ancestor that is not Created: a bundle may stand below Created entities.
      ecs::Entity root;
      for (ecs::Entity at = node; at && !registry_.has<Created>(at); at = parentOf(registry_, at)) root = at;
      if (root) roots_.try_emplace(bundle, root);
    };
    for (auto [entity, group] : registry_.view<scene::RigidGroupComponent>()) {
      groups_[{group.bundle, group.group}] = entity;
      take(group.bundle, group.node);
    }
    for (auto [entity, draw] : registry_.view<scene::DrawItem>()) take(draw.bundle, draw.node);
  }

  ecs::Entity parentRow(ecs::Entity entity) const {
    if (registry_.has<scene::Transform>(entity)) return parentOf(registry_, entity);
    ecs::Entity parent;
    if (const auto* group = registry_.tryGet<scene::RigidGroupComponent>(entity)) parent = group->node;
    if (const auto* lamp = registry_.tryGet<scene::LampComponent>(entity)) {
      const auto group = groups_.find({lamp->bundle, lamp->group});
      if (group != groups_.end()) parent = registry_.get<scene::RigidGroupComponent>(group->second).node;
    }
    if (registry_.alive(parent)) return parent;
    if (const auto bundle = bundleOf(registry_, entity)) {
      if (const auto root = roots_.find(*bundle); root != roots_.end()) return root->second;
    }
    return {};
  }

  void visit(ecs::Entity entity, std::uint32_t depth,
             std::vector<std::pair<ecs::Entity, std::uint32_t>>& open) {
    TreeRow row;
    row.entity = entity;
    row.id = document_.idOf(entity);
    row.depth = depth;
    row.kind = kind(entity);
    row.name = name(entity, row.kind);
    const auto below = children_.find(entity.index);
    row.has_children = below != children_.end();
    row.open = !query_.closed.contains(row.id) || !filter_.empty();
    row.matches = filter_.matches(document_, entity, row.name, row.kind);
    const bool descend = row.has_children && row.open;
    rows_.push_back(std::move(row));
    if (!descend) return;
    for (auto child = below->second.rbegin(); child != below->second.rend(); ++child)
      open.emplace_back(*child, depth + 1);
  }

  std::string_view kind(ecs::Entity entity) const {
    const bool root =
        std::any_of(roots_.begin(), roots_.end(), [&](const auto& entry) { return entry.second == entity; });
    return root ? "bundle" : kindWordOf(registry_, entity);
  }

  std::string name(ecs::Entity entity, std::string_view kind_word) const {
    if (const auto* own = registry_.tryGet<scene::Name>(entity); own && !own->value.empty())
      return own->value;
    return fmt::format("({})", kind_word);
  }

  // Keeps the rows that match and their ancestors. It walks upwards from the last row.
  void keepMatches() {
    std::vector<TreeRow> kept;
    std::uint32_t wanted_depth = 0;  // a row of smaller depth is an ancestor of a kept row
    for (auto row = rows_.rbegin(); row != rows_.rend(); ++row) {
      const bool above = row->depth < wanted_depth;
      if (!row->matches && !above) continue;
      wanted_depth = row->depth;
      kept.push_back(std::move(*row));
    }
    std::reverse(kept.begin(), kept.end());
    rows_ = std::move(kept);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      rows_[i].has_children = i + 1 < rows_.size() && rows_[i + 1].depth > rows_[i].depth;
  }

  const Document& document_;
  const ecs::Registry& registry_;
  const TreeQuery& query_;
  TreeFilter filter_;
  std::map<std::uint32_t, ecs::Entity> roots_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, ecs::Entity> groups_;
  std::unordered_map<std::uint32_t, std::vector<ecs::Entity>> children_;
  std::unordered_map<std::uint32_t, bool> seen_;
  std::vector<TreeRow> rows_;
};

}  // namespace

std::vector<TreeRow> treeRows(const Document& document, const TreeQuery& query) {
  return TreeBuilder(document, query).run();
}

std::uint64_t treeVersion(const ecs::Registry& registry) {
  // The version of Transforms would rise with every step of an animation, so the parents are hashed instead.
  std::uint64_t sum =
      registry.version<StableId>() + registry.version<Created>() + registry.version<scene::Name>();
  const auto mix = [&](std::uint64_t part) { sum = (sum ^ part) * 0x9e3779b97f4a7c15u + (sum >> 29); };
  for (auto [entity, place] : registry.view<scene::Transform>()) {
    mix(std::uint64_t{entity.index} << 32 | entity.generation);
    mix(std::uint64_t{place.parent.index} << 32 | place.parent.generation);
    mix(std::uint64_t{registry.has<scene::LocalLightComponent>(entity)} << 1 |
        std::uint64_t{registry.has<scene::CameraComponent>(entity)});
  }
  return sum;
}

const std::vector<TreeRow>& TreeRows::of(const Document& document) {
  const std::uint64_t version = treeVersion(document.registry());
  if (version == made_of_ && query == made_by_) return rows_;
  rows_ = treeRows(document, query);
  made_by_ = query;
  made_of_ = version;
  return rows_;
}

void Selection::clear() {
  if (!ids_.empty()) ++version_;
  ids_.clear();
  anchor_ = kNoId;
}

void Selection::set(StableId id) {
  set(std::span(&id, id == kNoId ? 0u : 1u));
}

void Selection::set(std::span<const StableId> ids) {
  std::vector<StableId> wanted;
  for (const StableId id : ids) {
    std::erase(wanted, id);  // for an id that occurs twice, the later place counts
    if (id != kNoId) wanted.push_back(id);
  }
  anchor_ = wanted.empty() ? kNoId : wanted.back();
  if (wanted == ids_) return;
  ids_ = std::move(wanted);
  ++version_;
}

void Selection::add(StableId id) {
  if (id == kNoId) return;
  anchor_ = id;
  if (primary() == id) return;
  std::erase(ids_, id);
  ids_.push_back(id);
  ++version_;
}

void Selection::remove(StableId id) {
  if (std::erase(ids_, id) > 0) ++version_;
}

void Selection::toggle(StableId id) {
  if (!contains(id)) return add(id);
  remove(id);
  anchor_ = id;
}

void Selection::range(std::span<const StableId> rows, StableId to) {
  const StableId anchor = anchor_ == kNoId ? to : anchor_;
  auto from = std::find(rows.begin(), rows.end(), anchor);
  auto last = std::find(rows.begin(), rows.end(), to);
  if (last == rows.end()) return;
  if (from == rows.end()) from = last;  // the row that was clicked first is not shown any more
  std::vector<StableId> wanted;
  for (auto at = from;; from < last ? ++at : --at) {
    wanted.push_back(*at);
    if (at == last) break;
  }
  set(wanted);
  anchor_ = anchor;
}

bool Selection::contains(StableId id) const {
  return std::find(ids_.begin(), ids_.end(), id) != ids_.end();
}

std::vector<ecs::Entity> Selection::entities(const Document& document) const {
  std::vector<ecs::Entity> there;
  for (const StableId id : ids_) {
    if (const ecs::Entity entity = document.find(id)) there.push_back(entity);
  }
  return there;
}

ecs::Entity Selection::primaryEntity(const Document& document) const {
  const std::vector<ecs::Entity> there = entities(document);
  return there.empty() ? ecs::Entity{} : there.back();
}

std::vector<ecs::Entity> Selection::topmost(const Document& document) const {
  const std::vector<ecs::Entity> there = entities(document);
  std::vector<ecs::Entity> tops;
  std::copy_if(there.begin(), there.end(), std::back_inserter(tops), [&](ecs::Entity entity) {
    return std::none_of(there.begin(), there.end(), [&](ecs::Entity other) {
      return other != entity && isBelow(document.registry(), entity, other);
    });
  });
  return tops;
}

namespace {

// Returns a small box around an entity that only has a position, in world space.
scene::Box boxAround(const ecs::Registry& registry, ecs::Entity entity) {
  const glm::vec3 at(worldFromNode(registry, entity)[3]);
  const auto* light = registry.tryGet<scene::LocalLightComponent>(entity);
  const glm::vec3 around(light ? std::max(0.1f, light->radius_m) : 0.1f);
  return {at - around, at + around};
}

// Returns the rotation and position of an entity's node without its scale, which boxes of draws contain.
glm::mat4 frameOf(const ecs::Registry& registry, ecs::Entity entity) {
  glm::mat4 frame = worldFromNode(registry, entity);
  for (int axis = 0; axis < 3; ++axis) {
    const float length = glm::length(glm::vec3(frame[axis]));
    if (!(length > 0.0f)) return glm::mat4(1.0f);
    frame[axis] /= length;
  }
  return std::abs(glm::determinant(frame)) > 1e-3f ? frame : glm::mat4(1.0f);
}

}  // namespace

scene::Box selectionBounds(const Document& document, const Selection& selection) {
  scene::Box bounds;
  const ecs::Registry& registry = document.registry();
  for (const ecs::Entity selected : selection.entities(document)) {
    if (registry.has<scene::RigidGroupComponent>(selected))
      bounds.add(scene::groupBounds(registry, selected));
    for (const auto [draw, item] : registry.view<const scene::DrawItem>())
      if (isBelow(registry, item.node, selected)) bounds.add(scene::drawBounds(registry, draw));
    if (bounds.empty() && registry.has<scene::Transform>(selected)) bounds.add(boxAround(registry, selected));
  }
  return bounds;
}

std::vector<TurnedBox> selectionBoxes(const Document& document, const Selection& selection) {
  std::vector<TurnedBox> boxes;
  const ecs::Registry& registry = document.registry();
  for (const ecs::Entity selected : selection.entities(document)) {
    TurnedBox turned;
    if (registry.has<scene::RigidGroupComponent>(selected)) {
      turned.box = scene::groupBounds(registry, selected);
    } else {
      turned.world_from_box = frameOf(registry, selected);
      const glm::mat4 box_from_world = glm::inverse(turned.world_from_box);
      for (const auto [draw, item] : registry.view<const scene::DrawItem>())
        if (isBelow(registry, item.node, selected))
          turned.box.add(
              scene::transformed(item.bounds, box_from_world * worldFromNode(registry, item.node)));
    }
    if (turned.box.empty() && registry.has<scene::Transform>(selected))
      turned = {glm::mat4(1.0f), boxAround(registry, selected)};
    if (!turned.box.empty()) boxes.push_back(turned);
  }
  return boxes;
}

}  // namespace lambent::editor
