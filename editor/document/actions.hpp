// Duplicates, resets, copies and pastes entities, as menus do, each as one step of the history. Copies are
// JSON text for the system's clipboard, so they go from one program to another (docs/world-file.md).
// Errors say what does not fit; nothing has changed then.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/baseline.hpp"
#include "editor/document/history.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

// Puts a copy of each entity, with all below it, beside its original and returns the copies. Takes Created
// entities, and those of bundles that consist of what a person could make (lights, cameras, empty nodes).
// Errors: one that shows a mesh of its bundle.
Result<std::vector<ecs::Entity>> duplicate(Document& document, History& history,
                                           std::span<const ecs::Entity> entities);

// Returns the value to which "reset" goes back: the bundle's, or the field's default for what a person has
// made.
scene::Value defaultValue(const Document& document, const Baseline& baseline, ecs::Entity entity,
                          const scene::FieldInfo& field);
bool isDefault(const Document& document, const Baseline& baseline, ecs::Entity entity,
               const scene::FieldInfo& field);
// Resets one field, or with an empty name all fields of the component, of all entities that have it.
Result<void> resetToDefault(Document& document, History& history, const Baseline& baseline,
                            std::span<const ecs::Entity> entities, std::string_view component,
                            std::string_view field = {});

// ---- clipboard

// Returns one component of an entity as text. Error: it has none.
Result<std::string> copyComponent(const Document& document, ecs::Entity entity, std::string_view component);
// Returns entities with all below them as text; takes those that duplicate() takes.
Result<std::string> copyEntities(const Document& document, std::span<const ecs::Entity> entities);

enum class Pasted { Nothing, Component, Entities };
// Tells what a text holds, so that menus can say "Paste Light".
struct Clip {
  Pasted kind = Pasted::Nothing;
  std::string component;  // of Pasted::Component
};
Clip peekClip(std::string_view text);

// Pastes a component onto all of the entities. One that a Created entity lacks is added where it may be.
// Errors: the text is no copy of ours, or damaged (names the JSON path); an entity that cannot take it.
Result<void> pasteComponent(Document& document, History& history, std::span<const ecs::Entity> entities,
                            std::string_view text);
// Makes the copied entities below `parent` (none: the world) and returns the topmost of them.
Result<std::vector<ecs::Entity>> pasteEntities(Document& document, History& history, ecs::Entity parent,
                                               std::string_view text);

}  // namespace lambent::editor
