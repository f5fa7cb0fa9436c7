#include "editor/document/history.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <glm/matrix.hpp>

#include "runtime/scene/components.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::editor {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <typename... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;  // Clang 16 deduces no arguments of aggregates

tl::unexpected<Error> gone() {
  return fail("entity", "is no longer there", "choose one that is");
}

}  // namespace

// ---- Carrying out changes.

void History::run(Change change) {
  std::vector<std::string> missing;
  apply(change, true, missing);
  assert(missing.empty() && "an edit of something that is not there");
  keep(std::move(change));
}

void History::keep(Change change) {
  ++version_;
  if (const auto* field = std::get_if<FieldChange>(&change)) {
    const auto [place, is_new] = joinable_.try_emplace({field->entity, field->field}, current_.size());
    if (!is_new) {
      std::get<FieldChange>(current_[place->second]).after = field->after;
      return;
    }
  } else if (const auto* world = std::get_if<WorldChange>(&change)) {
    const auto outer =
        std::find_if(scopes_.rbegin(), scopes_.rend(), [](const Scope& s) { return !s.single; });
    const bool joins = outer != scopes_.rend() && current_.size() > outer->first;
    if (auto* last = joins ? std::get_if<WorldChange>(&current_.back()) : nullptr) {
      last->after = world->after;
      return;
    }
  } else if (!std::holds_alternative<ParentChange>(change)) {
    joinable_.clear();  // values before and after an entity or component was created anew must not be joined
  }
  current_.push_back(std::move(change));
}

void History::apply(const Change& change, bool forth, std::vector<std::string>& missing) {
  ecs::Registry& registry = document_.registry();
  // Finds the entity, or adds its name to `missing`.
  const auto there = [&](StableId id) {
    const ecs::Entity entity = document_.find(id);
    if (!entity) missing.push_back(document_.nameOf(id));
    return entity;
  };
  std::visit(
      Overloaded{
          [&](const FieldChange& field) {
            const ecs::Entity entity = there(field.entity);
            if (entity && !field.field->restore(registry, entity, forth ? field.after : field.before))
              missing.push_back(fmt::format("{} of {}", field.field->component, document_.nameOf(entity)));
          },
          [&](const ParentChange& parent) {
            const ecs::Entity entity = there(parent.entity);
            if (!entity || !registry.has<scene::Transform>(entity)) return;
            const StableId wanted = forth ? parent.after : parent.before;
            registry.edit<scene::Transform>(entity).parent = wanted == kNoId ? ecs::Entity{} : there(wanted);
          },
          [&](const EntityChange& entity) {
            const StableId parent = entity.snapshot.parent;
            if (entity.made == forth) {
              if (parent != kNoId) there(parent);
              makeEntity(document_, entity.snapshot);
            } else if (const ecs::Entity doomed = there(entity.snapshot.id)) {
              registry.destroy(doomed);
            }
          },
          [&](const ComponentChange& component) {
            const ecs::Entity entity = there(component.entity);
            if (!entity) return;
            const scene::ComponentInfo& info = *component.values.component;
            if (component.added != forth) {
              info.remove(registry, entity);
              return;
            }
            info.add(registry, entity);
            for (std::size_t i = 0; i < info.fields.size(); ++i)
              info.fields[i].restore(registry, entity, component.values.values[i]);
          },
          [&](const WorldChange& world) { document_.setWorld(forth ? world.after : world.before); },
          [&](const OutsideChange& outside) { outside.carry_out(forth, missing); }},
      change);
}

// ---- Steps.

void History::begin(std::string name) {
  scopes_.push_back({std::move(name), current_.size(), /*single=*/false});
  joinable_.clear();  // an edit inside the scope may be cancelled and must not join an earlier one
}

void History::beginEdit(std::string name) {
  scopes_.push_back({std::move(name), current_.size(), /*single=*/true});
}

void History::commit() {
  assert(!scopes_.empty() && "commit() without begin()");
  endEdit();
}

void History::beginDrag(std::string name) {
  endDrag();
  begin(std::move(name));
  dragging_ = true;
}

void History::endDrag() {
  if (std::exchange(dragging_, false) && open()) commit();
}

void History::endEdit() {
  Scope scope = std::move(scopes_.back());
  scopes_.pop_back();
  if (!scopes_.empty()) return;
  joinable_.clear();
  push(std::move(scope.name), std::exchange(current_, {}));
}

void History::cancel() {
  assert(!scopes_.empty() && "cancel() without begin()");
  const std::size_t first = scopes_.back().first;
  scopes_.pop_back();
  std::vector<std::string> missing;
  for (; current_.size() > first; current_.pop_back()) apply(current_.back(), false, missing);
  joinable_.clear();
  ++version_;
}

std::size_t History::bytesOf(const Change& change) {
  std::size_t bytes = sizeof(change);
  if (const auto* field = std::get_if<FieldChange>(&change)) {
    for (const auto* value : {&field->before, &field->after})
      bytes += editor::bytesOf(*value) - sizeof(*value);
  } else if (const auto* entity = std::get_if<EntityChange>(&change)) {
    bytes += editor::bytesOf(entity->snapshot);
  } else if (const auto* component = std::get_if<ComponentChange>(&change)) {
    for (const scene::Value& value : component->values.values) bytes += editor::bytesOf(value);
  } else if (const auto* world = std::get_if<WorldChange>(&change)) {
    for (const WorldState* state : {&world->before, &world->after})
      bytes += 64 * (state->settings.size() + state->view.size() + state->lights.size()) +
               512 * state->bundles.size();
  } else if (const auto* outside = std::get_if<OutsideChange>(&change)) {
    bytes += outside->bytes;
  }
  return bytes;
}

void History::push(std::string name, std::vector<Change> changes) {
  // A value that returned to where it began is no change.
  std::erase_if(changes, [](const Change& change) {
    if (const auto* field = std::get_if<FieldChange>(&change))
      return scene::sameBits(field->before, field->after);
    const auto* world = std::get_if<WorldChange>(&change);
    return world && world->before == world->after;
  });
  if (changes.empty()) return;
  for (; steps_.size() > done_; steps_.pop_back()) bytes_ -= steps_.back().bytes;
  if (saved_ && *saved_ > forgotten_ + done_) saved_.reset();  // the saved state could be redone
  Step step{std::move(name), std::move(changes), 0};
  for (const Change& change : step.changes) step.bytes += bytesOf(change);
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
  for (auto change = step.changes.rbegin(); change != step.changes.rend(); ++change)
    apply(*change, false, replay.missing);
  ++version_;
  return replay;
}

Replay History::redo() {
  while (open()) commit();
  if (done_ == steps_.size()) return {};
  const Step& step = steps_[done_++];
  Replay replay{true, step.name, {}};
  for (const Change& change : step.changes) apply(change, true, replay.missing);
  ++version_;
  return replay;
}

std::string History::undoName() const {
  if (!current_.empty()) return "Undo " + scopes_.front().name;
  return done_ > 0 ? "Undo " + steps_[done_ - 1].name : "Undo";
}

std::vector<std::string> History::stepNames() const {
  std::vector<std::string> names;
  for (const Step& step : steps_) names.push_back(step.name);
  return names;
}

bool History::modified() const {
  return !current_.empty() || !saved_ || *saved_ != forgotten_ + done_;
}

bool History::modifiedInside() const {
  if (!current_.empty() || !saved_) return modified();
  const auto saved = static_cast<std::size_t>(*saved_ - forgotten_);
  for (std::size_t i = std::min(saved, done_); i < std::max(saved, done_); ++i)
    for (const Change& change : steps_[i].changes)
      if (!std::holds_alternative<OutsideChange>(change)) return true;
  return false;
}

void History::markSaved() {
  while (open()) commit();
  saved_ = forgotten_ + done_;
}

void History::clear() {
  scopes_.clear();
  current_.clear();
  joinable_.clear();
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
  beginEdit(name.empty() ? editName(document_, edits) : std::move(name));
  for (std::size_t i = 0; i < edits.size(); ++i) {
    scene::Value before = infos[i]->get(registry, edits[i].entity);
    if (scene::sameBits(before, edits[i].value)) continue;  // an unchanged value must not cause work
    run(FieldChange{document_.adopt(edits[i].entity), infos[i], std::move(before), edits[i].value});
  }
  endEdit();
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
  EntityChange change{snapshot, true};
  if (change.snapshot.id == kNoId) change.snapshot.id = document_.newId();
  const StableId id = change.snapshot.id;
  const scene::Value* label = snapshot.find("Name", "name");
  beginEdit("creation of " + (label ? std::get<std::string>(*label) : std::string("an entity")));
  run(std::move(change));
  endEdit();
  return document_.find(id);
}

Result<void> History::destroy(std::span<const ecs::Entity> entities) {
  const ecs::Registry& registry = document_.registry();
  for (const ecs::Entity entity : entities) {
    if (!registry.alive(entity)) return gone();
    document_.adopt(entity);
    if (!document_.created(entity))
      return fail(document_.nameOf(entity), "belongs to a bundle or to the world itself",
                  "take its bundle out of the world, or switch off what it does");
  }
  if (entities.empty()) return {};
  const std::vector<ecs::Entity> all = withDescendants(registry, {entities.begin(), entities.end()});
  beginEdit("removal of " + entitiesName(document_, entities));
  // Entities of bundles are not destroyed: the topmost of them are first moved to the top of the world.
  for (const ecs::Entity entity : all) {
    if (document_.created(entity) || !document_.created(parentOf(registry, entity))) continue;
    Result<std::vector<Change>> changes = moves(entity, {}, true);
    if (!changes) changes = moves(entity, {}, false);
    for (Change& change : *changes) run(std::move(change));
  }
  // Children are destroyed first, so that undo creates their parents first.
  std::vector<ecs::Entity> doomed;
  for (const ecs::Entity entity : withDescendants(registry, {entities.begin(), entities.end()}))
    if (document_.created(entity) || document_.idOf(entity) == kNoId) doomed.push_back(entity);
  for (auto entity = doomed.rbegin(); entity != doomed.rend(); ++entity) {
    document_.adopt(*entity);
    run(EntityChange{takeSnapshot(document_, *entity), false});
  }
  endEdit();
  return {};
}

Result<std::vector<History::Change>> History::moves(ecs::Entity entity, ecs::Entity parent, bool keep_place) {
  const ecs::Registry& registry = document_.registry();
  std::vector<Change> changes;
  const ecs::Entity before = parentOf(registry, entity);
  if (before == parent) return changes;
  const StableId id = document_.adopt(entity);
  const StableId parent_id = parent ? document_.adopt(parent) : kNoId;
  if (keep_place) {
    const glm::dmat4 world_from_parent(worldFromNode(registry, parent));
    const glm::dmat4 world_from_node(worldFromNode(registry, entity));
    const glm::mat4 parent_from_node(glm::inverse(world_from_parent) * world_from_node);
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        if (!std::isfinite(parent_from_node[column][row]))
          return fail(document_.nameOf(parent), "is flat: what hangs below it cannot keep its place",
                      "give it a scale other than 0");
      }
    }
    scene::Transform after = registry.get<scene::Transform>(entity);
    scene::setLocalMatrix(after, parent_from_node);
    for (const FieldEdit& edit : transformEdits(entity, after)) {
      const scene::FieldInfo* info = *scene::findField(edit.component, edit.field);
      const scene::Value now = info->get(registry, entity);
      if (!scene::sameBits(now, edit.value)) changes.push_back(FieldChange{id, info, now, edit.value});
    }
  }
  changes.push_back(ParentChange{id, document_.idOf(before), parent_id});
  return changes;
}

Result<void> History::reparent(std::span<const ecs::Entity> entities, ecs::Entity parent, bool keep_place) {
  const ecs::Registry& registry = document_.registry();
  if (parent && !registry.has<scene::Transform>(parent))
    return fail(document_.nameOf(parent), "has no place that something could hang below");
  for (const ecs::Entity entity : entities) {
    if (!registry.has<scene::Transform>(entity))
      return fail(document_.nameOf(entity), "has no place, so it hangs below nothing");
    if (isBelow(registry, parent, entity))
      return fail(document_.nameOf(parent), fmt::format("hangs below {}, or is it", document_.nameOf(entity)),
                  "choose a parent elsewhere");
  }
  std::vector<Change> all;
  for (const ecs::Entity entity : entities) {
    // An entity below another of the list moves with that one.
    const bool below = std::any_of(entities.begin(), entities.end(), [&](ecs::Entity other) {
      return other != entity && isBelow(registry, entity, other);
    });
    if (below) continue;
    Result<std::vector<Change>> changes = moves(entity, parent, keep_place);
    if (!changes) return failAgain(changes.error());
    std::move(changes->begin(), changes->end(), std::back_inserter(all));
  }
  beginEdit("new parent of " + entitiesName(document_, entities));
  for (Change& change : all) run(std::move(change));
  endEdit();
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
  ComponentChange change{document_.adopt(entity), {*info, {}}, true};
  for (const scene::FieldInfo& field : (*info)->fields) change.values.values.push_back(field.default_value);
  beginEdit(fmt::format("{} of {}", component, document_.nameOf(entity)));
  run(std::move(change));
  endEdit();
  return {};
}

Result<void> History::removeComponent(ecs::Entity entity, std::string_view component) {
  const Result<const scene::ComponentInfo*> info = changeable(entity, component, /*has=*/true);
  if (!info) return failAgain(info.error());
  beginEdit(fmt::format("removal of {} from {}", component, document_.nameOf(entity)));
  run(ComponentChange{document_.adopt(entity), componentValues(document_.registry(), entity, **info), false});
  endEdit();
  return {};
}

void History::setWorld(WorldState world, std::string name) {
  if (world == document_.world()) return;
  beginEdit(std::move(name));
  run(WorldChange{document_.world(), std::move(world)});
  endEdit();
}

void History::did(OutsideChange change, std::string name) {
  beginEdit(std::move(name));
  keep(std::move(change));
  endEdit();
}

}  // namespace lambent::editor
