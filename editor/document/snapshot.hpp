// Copies the editable state of an entity out of a registry as plain values, and creates an entity from it.
// The history, the clipboard and duplicate use these snapshots.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "editor/document/document.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

// Holds all fields of one component, in the order of ComponentInfo::fields.
struct ComponentValues {
  const scene::ComponentInfo* component = nullptr;
  std::vector<scene::Value> values;
};

struct EntitySnapshot {
  StableId id;      // kNoId: a new id is given
  StableId parent;  // kNoId: the world
  std::vector<ComponentValues> components;

  const scene::Value* find(std::string_view component, std::string_view field) const;
};

ComponentValues componentValues(const ecs::Registry& registry, ecs::Entity entity,
                                const scene::ComponentInfo& component);
// Takes a snapshot of an entity that has an id (Document::adopt).
EntitySnapshot takeSnapshot(const Document& document, ecs::Entity entity);
// Creates a Created entity with these components, below the world if its parent does not exist.
ecs::Entity makeEntity(Document& document, const EntitySnapshot& snapshot);
// Return the approximate memory use in bytes.
std::size_t bytesOf(const EntitySnapshot& snapshot);
std::size_t bytesOf(const scene::Value& value);

// Return what the Create menu makes. Each has a Name and a Transform.
EntitySnapshot emptyEntity(std::string name);
EntitySnapshot lightEntity(std::string_view kind, std::string name);  // kind: a word of Light.kind
EntitySnapshot cameraEntity(std::string name);

}  // namespace lambent::editor
