// Implements the edit commands of menus: duplicate, reset, copy and paste, each as one step of the history.
// A copy is JSON text for the system's clipboard, so it can be pasted into another program
// (docs/world-file.md). An error says what is wrong and changes nothing.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/history.hpp"
#include "editor/document/overrides.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

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

// ---- clipboard

// Returns one component of an entity as JSON text. Error: the entity does not have it.
Result<std::string> copyComponent(const Document& document, ecs::Entity entity, std::string_view component);
// Returns the entities with their descendants as JSON text. Takes the same entities as duplicate().
Result<std::string> copyEntities(const Document& document, std::span<const ecs::Entity> entities);

enum class Pasted { Nothing, Component, Entities };
Pasted peekClip(std::string_view text);

// Pastes a component onto all given entities. A Created entity that lacks the component gets it if the
// component may be added. Errors: the text was not copied by the editor; it is damaged (names the JSON path);
// an entity cannot take the component.
Result<void> pasteComponent(Document& document, History& history, std::span<const ecs::Entity> entities,
                            std::string_view text);
// Creates the copied entities below `parent` (none: at the top of the world) and returns the topmost ones.
Result<std::vector<ecs::Entity>> pasteEntities(Document& document, History& history, ecs::Entity parent,
                                               std::string_view text);

}  // namespace lambent::editor
