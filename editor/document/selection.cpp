#include "editor/document/selection.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "runtime/scene/components.hpp"

namespace lambent::editor {

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

scene::Box selectionBounds(const Document& document, const Selection& selection) {
  scene::Box bounds;
  const ecs::Registry& registry = document.registry();
  for (const ecs::Entity selected : selection.entities(document)) {
    if (registry.has<scene::RigidGroupComponent>(selected))
      bounds.add(scene::groupBounds(registry, selected));
    for (const auto [draw, item] : registry.view<const scene::DrawItem>())
      if (draw == selected || item.node == selected || isBelow(registry, item.node, selected))
        bounds.add(scene::drawBounds(registry, draw));
    if (bounds.empty() && registry.has<scene::Transform>(selected)) {
      const glm::vec3 at(worldFromNode(registry, selected)[3]);
      const auto* light = registry.tryGet<scene::LocalLightComponent>(selected);
      const glm::vec3 around(light ? std::max(0.1f, light->radius_m) : 0.1f);
      bounds.add(at - around), bounds.add(at + around);
    }
  }
  return bounds;
}

void Selection::prune(const Document& document) {
  if (std::erase_if(ids_, [&](StableId id) { return !document.find(id); }) > 0) ++version_;
}

}  // namespace lambent::editor
