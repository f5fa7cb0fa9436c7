#include "editor/document/history.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

#include <fmt/format.h>
#include <glm/matrix.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::editor {
namespace {

tl::unexpected<Error> gone() {
  return fail("entity", "is no longer there", "choose one that is");
}

const ComponentValues* find(const EntitySnapshot& snapshot, const scene::ComponentInfo* component) {
  const auto found = std::ranges::find(snapshot.components, component, &ComponentValues::component);
  return found == snapshot.components.end() ? nullptr : &*found;
}

bool same(const ComponentValues& a, const ComponentValues* b) {
  return b && std::ranges::equal(a.values, b->values, scene::sameBits);
}

std::size_t bytesOf(const EntitySnapshot& snapshot) {
  std::size_t bytes = sizeof(snapshot);
  for (const ComponentValues& part : snapshot.components) {
    bytes += sizeof(part) + part.values.size() * sizeof(scene::Value);
    for (const scene::Value& value : part.values)
      if (const auto* text = std::get_if<std::string>(&value)) bytes += text->size();
  }
  return bytes;
}

}  // namespace

std::size_t History::State::bytes() const {
  std::size_t bytes = 0;
  for (const auto& [id, snapshot] : entities) bytes += sizeof(id) + (snapshot ? bytesOf(*snapshot) : 0);
  if (world)
    bytes += sizeof(*world) + 64 * (world->settings.size() + world->view.size() + world->lights.size()) +
             512 * world->bundles.size();
  return bytes;
}

// ---- What a step touches.

void History::touch(ecs::Entity entity) {
  touch(document_.adopt(entity));
}

void History::touch(StableId id) {
  ++version_;
  auto& entities = scopes_.back().before.entities;
  if (entities.contains(id)) return;
  const ecs::Entity entity = document_.find(id);
  entities.emplace(id, entity ? std::optional(takeSnapshot(document_, entity)) : std::nullopt);
}

bool History::edited() const {
  return std::ranges::any_of(scopes_, [](const Scope& scope) { return !scope.before.empty(); });
}

History::State History::now(const State& before) const {
  State state;
  for (const auto& [id, snapshot] : before.entities) {
    const ecs::Entity entity = document_.find(id);
    state.entities.emplace(id, entity ? std::optional(takeSnapshot(document_, entity)) : std::nullopt);
  }
  if (before.world) state.world = document_.world();
  return state;
}

void History::keepDifferences(State& before, State& after) {
  for (auto at = before.entities.begin(); at != before.entities.end();) {
    std::optional<EntitySnapshot>& from = at->second;
    std::optional<EntitySnapshot>& to = after.entities.at(at->first);
    bool differs = from.has_value() != to.has_value();
    if (from && to) {
      const auto unchanged = [](const EntitySnapshot& other) {
        return [&other](const ComponentValues& part) { return same(part, find(other, part.component)); };
      };
      EntitySnapshot rest = *from;
      std::erase_if(rest.components, unchanged(*to));
      std::erase_if(to->components, unchanged(*from));
      from = std::move(rest);
      differs = !from->components.empty() || !to->components.empty() || from->parent != to->parent;
    }
    if (!differs) after.entities.erase(at->first);
    at = differs ? std::next(at) : before.entities.erase(at);
  }
  if (before.world == after.world) before.world.reset(), after.world.reset();
}

void History::goEntity(StableId id, const std::optional<EntitySnapshot>& from,
                       const std::optional<EntitySnapshot>& to, std::vector<std::string>& missing) {
  ecs::Registry& registry = document_.registry();
  if (!from && to) {
    makeEntity(document_, *to);
    return;
  }
  const ecs::Entity entity = document_.find(id);
  if (!entity) {
    missing.push_back(document_.nameOf(id));
    return;
  }
  if (!to) {
    registry.destroy(entity);
    return;
  }
  for (const ComponentValues& part : from->components)
    if (!find(*to, part.component)) part.component->remove(registry, entity);
  for (const ComponentValues& part : to->components) {
    const ComponentValues* before = find(*from, part.component);
    if (!before) part.component->add(registry, entity);
    bool there = true;
    for (std::size_t i = 0; i < part.values.size(); ++i)
      if (!before || !scene::sameBits(before->values[i], part.values[i]))
        there = part.component->fields[i].restore(registry, entity, part.values[i]) && there;
    if (!there) missing.push_back(fmt::format("{} of {}", part.component->name, document_.nameOf(entity)));
  }
}

void History::goParent(StableId id, const std::optional<EntitySnapshot>& from, const EntitySnapshot& to,
                       std::vector<std::string>& missing) {
  ecs::Registry& registry = document_.registry();
  const ecs::Entity entity = document_.find(id);
  if ((from && from->parent == to.parent) || !registry.has<scene::Transform>(entity)) return;
  const ecs::Entity parent = document_.find(to.parent);
  if (to.parent != kNoId && !parent) missing.push_back(document_.nameOf(to.parent));
  registry.edit<scene::Transform>(entity).parent = parent;
}

void History::go(const State& from, const State& to, std::vector<std::string>& missing) {
  for (const auto& [id, snapshot] : to.entities) goEntity(id, from.entities.at(id), snapshot, missing);
  // Parents are set last, when all entities exist.
  for (const auto& [id, snapshot] : to.entities)
    if (snapshot) goParent(id, from.entities.at(id), *snapshot, missing);
  if (to.world) document_.setWorld(*to.world);
  ++version_;
}

// ---- Steps.

void History::begin(std::string name) {
  scopes_.push_back({std::move(name), {}});
}

void History::commit() {
  assert(!scopes_.empty() && "commit() without begin()");
  Scope scope = std::move(scopes_.back());
  scopes_.pop_back();
  if (scopes_.empty()) {
    State after = now(scope.before);
    keepDifferences(scope.before, after);
    if (!after.empty()) push({std::move(scope.name), std::move(scope.before), std::move(after)});
    return;
  }
  State& outer = scopes_.back().before;
  outer.entities.merge(scope.before.entities);  // keeps what the outer scope has already
  if (!outer.world) outer.world = std::move(scope.before.world);
}

void History::beginDrag(std::string name) {
  endDrag();
  begin(std::move(name));
  dragging_ = true;
}

void History::endDrag() {
  if (std::exchange(dragging_, false) && open()) commit();
}

void History::cancel() {
  assert(!scopes_.empty() && "cancel() without begin()");
  const Scope scope = std::move(scopes_.back());
  scopes_.pop_back();
  std::vector<std::string> missing;
  go(now(scope.before), scope.before, missing);
}

void History::push(Step step) {
  for (; steps_.size() > done_; steps_.pop_back()) bytes_ -= steps_.back().bytes;
  if (saved_ && *saved_ > forgotten_ + done_) saved_.reset();  // the saved state could be redone
  step.bytes = sizeof(step) + step.before.bytes() + step.after.bytes();
  bytes_ += step.bytes;
  steps_.push_back(std::move(step));
  ++done_;
  forgetOldest();
}

void History::forgetOldest() {
  while (bytes_ > max_bytes_ && steps_.size() > 1) {
    bytes_ -= steps_.front().bytes;
    steps_.pop_front();
    --done_;
    ++forgotten_;
  }
  if (saved_ && *saved_ < forgotten_) saved_.reset();
}

Replay History::undo() {
  while (open()) commit();
  if (done_ == 0) return {};
  const Step& step = steps_[--done_];
  Replay replay{true, step.name, {}};
  go(step.after, step.before, replay.missing);
  return replay;
}

Replay History::redo() {
  while (open()) commit();
  if (done_ == steps_.size()) return {};
  const Step& step = steps_[done_++];
  Replay replay{true, step.name, {}};
  go(step.before, step.after, replay.missing);
  return replay;
}

std::string History::undoName() const {
  if (edited()) return "Undo " + scopes_.front().name;
  return done_ > 0 ? "Undo " + steps_[done_ - 1].name : "Undo";
}

void History::markSaved() {
  while (open()) commit();
  saved_ = forgotten_ + done_;
}

void History::clear() {
  scopes_.clear();
  steps_.clear();
  bytes_ = 0;
  done_ = 0;
  forgotten_ = 0;
  saved_ = 0;
  ++version_;
}

// ---- Edits.

std::string entitiesName(const Document& document, std::span<const ecs::Entity> entities) {
  if (entities.size() == 1) return document.nameOf(entities.front());
  return fmt::format("{} entities", entities.size());
}

std::vector<FieldEdit> transformEdits(ecs::Entity entity, const scene::Transform& to) {
  return {{entity, "Transform", "translation", to.translation},
          {entity, "Transform", "rotation", to.rotation},
          {entity, "Transform", "scale", to.scale},
          {entity, "Transform", "shear", to.shear}};
}

std::string editName(const Document& document, std::span<const FieldEdit> edits) {
  if (edits.empty()) return "nothing";
  std::vector<ecs::Entity> entities;
  bool one_field = true, one_component = true;
  for (const FieldEdit& edit : edits) {
    one_component = one_component && edit.component == edits.front().component;
    one_field = one_field && one_component && edit.field == edits.front().field;
    if (std::find(entities.begin(), entities.end(), edit.entity) == entities.end())
      entities.push_back(edit.entity);
  }
  std::string what = "edit";
  if (one_field) {
    what = edits.front().field;
    if (edits.front().component == "Transform") {
      if (what == "translation") what = "move";
      if (what == "rotation") what = "turn";
    }
  } else if (one_component) {
    what = edits.front().component == "Transform" ? "move" : std::string(edits.front().component);
  }
  return what + " of " + entitiesName(document, entities);
}

Result<void> History::setField(ecs::Entity entity, std::string_view component, std::string_view field,
                               scene::Value value) {
  const FieldEdit edit{entity, component, field, std::move(value)};
  return setFields({&edit, 1});
}

Result<void> History::setFields(std::span<const FieldEdit> edits, std::string name, bool in_range) {
  ecs::Registry& registry = document_.registry();
  std::vector<const scene::FieldInfo*> infos;
  for (const FieldEdit& edit : edits) {
    if (!registry.alive(edit.entity)) return gone();
    const Result<const scene::FieldInfo*> info = scene::findField(edit.component, edit.field);
    if (!info) return failAgain(info.error());
    if (!scene::findComponent(edit.component)->has(registry, edit.entity))
      return fail(document_.nameOf(edit.entity), fmt::format("has no {}", edit.component));
    const bool fits = scene::kindOf(edit.value) == (*info)->kind;
    if (const Result<void> good = (*info)->check(edit.value); !good && (in_range || !fits)) {
      Error error = good.error();
      error.subject += " of " + document_.nameOf(edit.entity);
      return failAgain(error);
    }
    infos.push_back(*info);
  }
  make(name.empty() ? editName(document_, edits) : std::move(name), [&] {
    for (std::size_t i = 0; i < edits.size(); ++i) {
      const ecs::Entity entity = edits[i].entity;
      // An unchanged value must not cause work.
      if (scene::sameBits(infos[i]->get(registry, entity), edits[i].value)) continue;
      touch(entity);
      infos[i]->restore(registry, entity, edits[i].value);
    }
  });
  return {};
}

Result<ecs::Entity> History::create(const EntitySnapshot& snapshot) {
  if (snapshot.parent != kNoId) {
    const ecs::Entity parent = document_.find(snapshot.parent);
    if (!parent) return fail("parent " + idText(snapshot.parent), "is not there");
    if (!document_.registry().has<scene::Transform>(parent))
      return fail(document_.nameOf(parent), "has no place that something could hang below");
  }
  if (snapshot.id != kNoId && document_.find(snapshot.id))
    return fail(document_.nameOf(snapshot.id), "is there already", "leave the id out to get a new one");
  for (const ComponentValues& part : snapshot.components) {
    if (!part.component->addable)
      return fail(std::string(part.component->name), "cannot be made by hand: it comes with a bundle");
    if (part.values.size() != part.component->fields.size())
      return fail(std::string(part.component->name), "has not as many values as fields");
    for (std::size_t i = 0; i < part.values.size(); ++i) {
      const scene::FieldInfo& field = part.component->fields[i];
      if (const Result<void> good = field.check(part.values[i]); !good) return failAgain(good.error());
    }
  }
  EntitySnapshot made = snapshot;
  if (made.id == kNoId) made.id = document_.newId();
  const scene::Value* label = snapshot.find("Name", "name");
  ecs::Entity entity;
  make("creation of " + (label ? std::get<std::string>(*label) : std::string("an entity")), [&] {
    touch(made.id);
    entity = makeEntity(document_, made);
  });
  return entity;
}

Result<void> History::destroy(std::span<const ecs::Entity> entities) {
  ecs::Registry& registry = document_.registry();
  for (const ecs::Entity entity : entities) {
    if (!registry.alive(entity)) return gone();
    document_.adopt(entity);
    if (!document_.created(entity))
      return fail(document_.nameOf(entity), "belongs to a bundle or to the world itself",
                  "take its bundle out of the world, or switch off what it does");
  }
  if (entities.empty()) return {};
  const std::vector<ecs::Entity> all = withDescendants(registry, {entities.begin(), entities.end()});
  make("removal of " + entitiesName(document_, entities), [&] {
    // Entities of bundles are not destroyed: the topmost of them are first moved to the top of the world.
    for (const ecs::Entity entity : all) {
      if (document_.created(entity) || !document_.created(parentOf(registry, entity))) continue;
      const Result<scene::Transform> stays = below({}, entity, /*keep_place=*/true);
      touch(entity);
      registry.edit<scene::Transform>(entity) = stays ? *stays : *below({}, entity, /*keep_place=*/false);
    }
    std::vector<ecs::Entity> doomed;
    for (const ecs::Entity entity : withDescendants(registry, {entities.begin(), entities.end()})) {
      if (!document_.created(entity) && document_.idOf(entity) != kNoId) continue;
      touch(entity);
      doomed.push_back(entity);
    }
    for (const ecs::Entity entity : doomed) registry.destroy(entity);
  });
  return {};
}

Result<scene::Transform> History::below(ecs::Entity parent, ecs::Entity entity, bool keep_place) const {
  const ecs::Registry& registry = document_.registry();
  scene::Transform after = registry.get<scene::Transform>(entity);
  after.parent = parent;
  if (!keep_place) return after;
  const glm::dmat4 world_from_parent(worldFromNode(registry, parent));
  const glm::dmat4 world_from_node(worldFromNode(registry, entity));
  const glm::mat4 parent_from_node(glm::inverse(world_from_parent) * world_from_node);
  if (!isFinite(parent_from_node))
    return fail(document_.nameOf(parent), "is flat: what hangs below it cannot keep its place",
                "give it a scale other than 0");
  scene::setLocalMatrix(after, parent_from_node);
  return after;
}

Result<void> History::reparent(std::span<const ecs::Entity> entities, ecs::Entity parent, bool keep_place) {
  ecs::Registry& registry = document_.registry();
  if (parent && !registry.has<scene::Transform>(parent))
    return fail(document_.nameOf(parent), "has no place that something could hang below");
  for (const ecs::Entity entity : entities) {
    if (!registry.has<scene::Transform>(entity))
      return fail(document_.nameOf(entity), "has no place, so it hangs below nothing");
    if (isBelow(registry, parent, entity))
      return fail(document_.nameOf(parent), fmt::format("hangs below {}, or is it", document_.nameOf(entity)),
                  "choose a parent elsewhere");
  }
  std::vector<std::pair<ecs::Entity, scene::Transform>> moved;
  for (const ecs::Entity entity : entities) {
    // An entity below another of the list moves with that one.
    const bool with_other = std::any_of(entities.begin(), entities.end(), [&](ecs::Entity other) {
      return other != entity && isBelow(registry, entity, other);
    });
    if (with_other || parentOf(registry, entity) == parent) continue;
    const Result<scene::Transform> after = below(parent, entity, keep_place);
    if (!after) return failAgain(after.error());
    moved.emplace_back(entity, *after);
  }
  make("new parent of " + entitiesName(document_, entities), [&] {
    if (parent && !moved.empty()) document_.adopt(parent);
    for (const auto& [entity, after] : moved) {
      touch(entity);
      registry.edit<scene::Transform>(entity) = after;
    }
  });
  return {};
}

Result<const scene::ComponentInfo*> History::changeable(ecs::Entity entity, std::string_view component,
                                                        bool has) const {
  const scene::ComponentInfo* info = scene::findComponent(component);
  if (!info) return fail(fmt::format("component \"{}\"", component), "is not known");
  if (!document_.registry().alive(entity)) return gone();
  if (!info->removable) return fail(std::string(component), "is not added or removed by hand");
  if (!document_.created(entity) && document_.idOf(entity) != kNoId)
    return fail(document_.nameOf(entity), "belongs to a bundle, which says what it carries",
                "make an entity below it");
  if (info->has(document_.registry(), entity) == has) return info;
  return fail(document_.nameOf(entity),
              has ? fmt::format("has no {}", component) : fmt::format("has a {} already", component));
}

Result<void> History::addComponent(ecs::Entity entity, std::string_view component) {
  const Result<const scene::ComponentInfo*> info = changeable(entity, component, /*has=*/false);
  if (!info) return failAgain(info.error());
  make(fmt::format("{} of {}", component, document_.nameOf(entity)), [&] {
    touch(entity);
    (*info)->add(document_.registry(), entity);
  });
  return {};
}

Result<void> History::removeComponent(ecs::Entity entity, std::string_view component) {
  const Result<const scene::ComponentInfo*> info = changeable(entity, component, /*has=*/true);
  if (!info) return failAgain(info.error());
  make(fmt::format("removal of {} from {}", component, document_.nameOf(entity)), [&] {
    touch(entity);
    (*info)->remove(document_.registry(), entity);
  });
  return {};
}

void History::setWorld(WorldState world, std::string name) {
  if (world == document_.world()) return;
  make(std::move(name), [&] {
    ++version_;
    std::optional<WorldState>& before = scopes_.back().before.world;
    if (!before) before = document_.world();
    document_.setWorld(std::move(world));
  });
}

}  // namespace lambent::editor
