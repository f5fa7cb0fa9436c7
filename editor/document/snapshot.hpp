// Holds entities as values: what a person may have set of one, taken out of a registry and put back. History
// keeps snapshots of what was destroyed, the clipboard and duplicates are made of them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "editor/document/document.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

// All fields of one component, in the order of ComponentInfo::fields.
struct ComponentValues {
  const scene::ComponentInfo* component = nullptr;
  std::vector<scene::Value> values;
};

struct EntitySnapshot {
  StableId id;      // kNoId: gets a new one
  StableId parent;  // kNoId: the world
  std::vector<ComponentValues> components;

  const scene::Value* find(std::string_view component, std::string_view field) const;
};

ComponentValues componentValues(const ecs::Registry& registry, ecs::Entity entity,
                                const scene::ComponentInfo& component);
// Takes an entity that has an id (Document::adopt).
EntitySnapshot takeSnapshot(const Document& document, ecs::Entity entity);
// Makes a Created entity with these components, in the world if its parent is not there.
ecs::Entity makeEntity(Document& document, const EntitySnapshot& snapshot);
// Return about how much memory they take.
std::size_t bytesOf(const EntitySnapshot& snapshot);
std::size_t bytesOf(const scene::Value& value);

// Return what the menus make. Each has a Name and a Transform.
EntitySnapshot emptyEntity(std::string name);
EntitySnapshot lightEntity(std::string_view kind, std::string name);  // a word of Light.kind
EntitySnapshot cameraEntity(std::string name);

}  // namespace lambent::editor
