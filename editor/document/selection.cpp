#include "editor/document/selection.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

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
  const auto* draw = registry.tryGet<scene::DrawItem>(entity);
  glm::mat4 frame = worldFromNode(registry, draw ? draw->node : entity);
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
      if (draw == selected || item.node == selected || isBelow(registry, item.node, selected))
        bounds.add(scene::drawBounds(registry, draw));
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
        if (draw == selected || item.node == selected || isBelow(registry, item.node, selected))
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
