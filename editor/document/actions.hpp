// Implements the edit commands of menus: duplicate, reset, copy and paste, each as one step of the history.
// An error says what is wrong and changes nothing.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/history.hpp"
#include "editor/document/overrides.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

// Returns the name if no entity has it, or else with the next free number: "ball 2".
std::string unusedName(const Document& document, const std::string& name);

// Copies each entity with its descendants, places the copy beside its original and returns the copies. Takes
// Created entities, and those entities of bundles that a person could have made (lights, cameras, empty
// nodes). Errors: an entity that shows a mesh of its bundle.
Result<std::vector<ecs::Entity>> duplicate(Document& document, History& history,
                                           std::span<const ecs::Entity> entities);

// Returns the value that "reset" restores: the bundle's value, or the field's default for a Created entity.
scene::Value defaultValue(const Document& document, const Baseline& baseline, ecs::Entity entity,
                          const scene::FieldInfo& field);
bool isDefault(const Document& document, const Baseline& baseline, ecs::Entity entity,
               const scene::FieldInfo& field);
// Resets a field of every given entity that has it; an empty field name resets all fields of the component.
Result<void> resetToDefault(Document& document, History& history, const Baseline& baseline,
                            std::span<const ecs::Entity> entities, std::string_view component,
                            std::string_view field = {});

// Copies entities with their descendants, parents first. Takes the same entities as duplicate().
Result<std::vector<EntitySnapshot>> copyEntities(const Document& document,
                                                 std::span<const ecs::Entity> entities);
// Creates copied entities at the top of the world, and returns the topmost ones.
Result<std::vector<ecs::Entity>> pasteEntities(Document& document, History& history,
                                               std::vector<EntitySnapshot> copies);

}  // namespace lambent::editor
