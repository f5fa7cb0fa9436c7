#include "editor/document/actions.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "runtime/scene/components.hpp"

namespace lambent::editor {

namespace {

// Returns snapshots of the entities and their descendants, parents first. Errors: those of duplicate().
Result<std::vector<EntitySnapshot>> copiesOf(const Document& document,
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

// Creates entities from the snapshots as one step of the history. Returns those whose parent is not among
// them.
Result<std::vector<ecs::Entity>> makeCopies(Document& document, History& history,
                                            std::vector<EntitySnapshot> copies, std::string name) {
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
  Result<std::vector<EntitySnapshot>> copies = copiesOf(document, entities);
  if (!copies) return failAgain(copies.error());
  history.begin("duplicate of " + entitiesName(document, entities));
  const Result<std::vector<ecs::Entity>> made = makeCopies(document, history, std::move(*copies), "copies");
  if (!made) {
    history.cancel();
    return made;
  }
  for (const ecs::Entity entity : *made) {
    if (const Result<void> named =
            history.setField(entity, "Name", "name", unusedName(document, document.nameOf(entity)));
        !named) {
      history.cancel();
      return failAgain(named.error());
    }
  }
  history.commit();
  return made;
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

Result<Clip> copyComponent(const Document& document, ecs::Entity entity, std::string_view component) {
  const scene::ComponentInfo* info = scene::findComponent(component);
  if (!info || !info->has(document.registry(), entity))
    return fail(document.nameOf(entity), fmt::format("has no {}", component));
  return Clip{.component = componentValues(document.registry(), entity, *info), .entities = {}};
}

Result<Clip> copyEntities(const Document& document, std::span<const ecs::Entity> entities) {
  return copiesOf(document, entities).map([](std::vector<EntitySnapshot> copies) {
    return Clip{.component = {}, .entities = std::move(copies)};
  });
}

Result<void> pasteComponent(Document& document, History& history, std::span<const ecs::Entity> entities,
                            const ComponentValues& component) {
  const scene::ComponentInfo& info = *component.component;
  history.begin(fmt::format("paste of {} onto {}", info.name, entitiesName(document, entities)));
  std::vector<FieldEdit> edits;
  for (const ecs::Entity entity : entities) {
    if (!info.has(document.registry(), entity)) {
      if (const Result<void> added = history.addComponent(entity, info.name); !added) {
        history.cancel();
        return added;
      }
    }
    for (std::size_t i = 0; i < component.values.size(); ++i)
      edits.push_back({entity, info.name, info.fields[i].name, component.values[i]});
  }
  if (const Result<void> set = history.setFields(edits); !set) {
    history.cancel();
    return set;
  }
  history.commit();
  return {};
}

Result<std::vector<ecs::Entity>> pasteEntities(Document& document, History& history,
                                               std::vector<EntitySnapshot> copies) {
  for (EntitySnapshot& copy : copies)
    if (std::ranges::find(copies, copy.parent, &EntitySnapshot::id) == copies.end()) copy.parent = kNoId;
  return makeCopies(document, history, std::move(copies), "paste");
}

}  // namespace lambent::editor
