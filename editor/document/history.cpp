#include "editor/document/history.hpp"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "runtime/scene/components.hpp"

namespace lambent::editor {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <typename... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;  // Clang 16 deduces no arguments of aggregates

}  // namespace

History::History(Document& document, std::size_t max_bytes) : document_(document), max_bytes_(max_bytes) {}

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

std::string History::redoName() const {
  return canRedo() ? "Redo " + steps_[done_].name : "Redo";
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

}  // namespace lambent::editor
