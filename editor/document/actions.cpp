#include "editor/document/actions.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "runtime/scene/components.hpp"

namespace lambent::editor {

Result<std::vector<EntitySnapshot>> copyEntities(const Document& document,
                                                 std::span<const ecs::Entity> entities) {
  const ecs::Registry& registry = document.registry();
  std::map<ecs::Entity, const scene::DrawItem*> draws;
  for (auto [entity, draw] : registry.view<scene::DrawItem>()) draws[draw.node] = &draw;
  std::vector<EntitySnapshot> copies;
  for (const ecs::Entity entity : withDescendants(registry, {entities.begin(), entities.end()})) {
    if (draws.contains(entity))
      return fail(document.nameOf(entity), "shows a mesh of its bundle, which cannot be copied alone",
                  "put the bundle into the world a second time");
    EntitySnapshot copy = takeSnapshot(document, entity);
    std::erase_if(copy.components, [](const ComponentValues& part) { return !part.component->addable; });
    if (copy.find("Transform", "translation") == nullptr)
      return fail(document.nameOf(entity), "belongs to a bundle or to the world itself",
                  "choose lights, cameras or empty nodes");
    if (copy.find("Name", "name") == nullptr)
      copy.components.insert(copy.components.begin(), emptyEntity("copy").components.front());
    copies.push_back(std::move(copy));
  }
  return copies;
}

namespace {

std::string nameIn(const EntitySnapshot& snapshot) {
  const auto& name = std::get<std::string>(*snapshot.find("Name", "name"));
  return name.empty() ? "copy" : name;
}

// Creates entities from the snapshots as one step of the history. Returns those whose parent is not among
// them. rename: these get names that no entity has.
Result<std::vector<ecs::Entity>> makeCopies(Document& document, History& history,
                                            std::vector<EntitySnapshot> copies, std::string name,
                                            bool rename) {
  // Every copy gets a new id, and its parent is renamed if it is a copy, too.
  std::map<StableId, StableId> renamed;
  for (const EntitySnapshot& copy : copies) renamed[copy.id] = document.newId();
  std::vector<StableId> tops;
  history.begin(std::move(name));
  for (EntitySnapshot& copy : copies) {
    copy.id = renamed[copy.id];
    const auto parent = renamed.find(copy.parent);
    if (parent != renamed.end())
      copy.parent = parent->second;
    else
      tops.push_back(copy.id);
    if (rename && parent == renamed.end()) copy.put("Name", "name", unusedName(document, nameIn(copy)));
    if (const Result<ecs::Entity> made = history.create(copy); !made) {
      history.cancel();
      return failAgain(made.error());
    }
  }
  history.commit();
  std::vector<ecs::Entity> entities;
  for (const StableId id : tops) entities.push_back(document.find(id));
  return entities;
}

}  // namespace

std::string unusedName(const Document& document, const std::string& name) {
  std::vector<std::string> taken;
  for (auto [entity, there] : std::as_const(document.registry()).view<scene::Name>())
    taken.push_back(there.value);
  std::string stem = name;
  while (!stem.empty() && stem.back() >= '0' && stem.back() <= '9') stem.pop_back();
  if (stem.empty() || stem.size() == name.size() || stem.back() != ' ') stem = name + " ";
  std::string next = name;
  for (int number = 2; std::ranges::find(taken, next) != taken.end(); ++number)
    next = stem + std::to_string(number);
  return next;
}

Result<std::vector<ecs::Entity>> duplicate(Document& document, History& history,
                                           std::span<const ecs::Entity> entities) {
  for (const ecs::Entity entity : entities) document.adopt(entity);
  Result<std::vector<EntitySnapshot>> copies = copyEntities(document, entities);
  if (!copies) return failAgain(copies.error());
  const std::string name = "duplicate of " + entitiesName(document, entities);
  return makeCopies(document, history, std::move(*copies), name, /*rename=*/true);
}

scene::Value defaultValue(const Document& document, const Baseline& baseline, ecs::Entity entity,
                          const scene::FieldInfo& field) {
  if (!document.created(entity)) {
    if (const auto value = baseline.value(document.idOf(entity), field)) return *value;
  }
  return field.default_value;
}

bool isDefault(const Document& document, const Baseline& baseline, ecs::Entity entity,
               const scene::FieldInfo& field) {
  return scene::sameBits(field.get(document.registry(), entity),
                         defaultValue(document, baseline, entity, field));
}

Result<void> resetToDefault(Document& document, History& history, const Baseline& baseline,
                            std::span<const ecs::Entity> entities, std::string_view component,
                            std::string_view field) {
  const scene::ComponentInfo* info = scene::findComponent(component);
  if (!info) return fail(fmt::format("component \"{}\"", component), "is not known");
  if (!field.empty() && !info->field(field)) return failAgain(scene::findField(component, field).error());
  std::vector<FieldEdit> edits;
  for (const ecs::Entity entity : entities) {
    if (!info->has(document.registry(), entity)) continue;
    for (const scene::FieldInfo& row : info->fields) {
      if (field.empty() || row.name == field)
        edits.push_back({entity, info->name, row.name, defaultValue(document, baseline, entity, row)});
    }
  }
  // A value of a bundle may lie outside the field's range and is still its default.
  return history.setFields(
      edits,
      fmt::format("reset of {} of {}", field.empty() ? component : field, entitiesName(document, entities)),
      /*in_range=*/false);
}

Result<std::vector<ecs::Entity>> pasteEntities(Document& document, History& history,
                                               std::vector<EntitySnapshot> copies) {
  for (EntitySnapshot& copy : copies)
    if (std::ranges::find(copies, copy.parent, &EntitySnapshot::id) == copies.end()) copy.parent = kNoId;
  return makeCopies(document, history, std::move(copies), "paste", /*rename=*/false);
}

}  // namespace lambent::editor
