// What menus do with the selection, each one step in the history: duplicate, reset, copy and paste. Copies
// are JSON text for the system's clipboard, so they go from one program to another (docs/world-file.md).
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

// Created ones with all below them, each beside its original; of bundles' entities those that consist of
// what a person could make (lights, cameras, empty nodes). Returns the copies. Errors: one that shows a mesh
// of its bundle.
Result<std::vector<ecs::Entity>> duplicate(Document& document, History& history,
                                           std::span<const ecs::Entity> entities);

// The value to which "reset" goes back: the bundle's, or the field's default for what a person has made.
scene::Value defaultValue(const Document& document, const Baseline& baseline, ecs::Entity entity,
                          const scene::FieldInfo& field);
bool isDefault(const Document& document, const Baseline& baseline, ecs::Entity entity,
               const scene::FieldInfo& field);
// One field, or with an empty name all fields of the component, of all entities that have it.
Result<void> resetToDefault(Document& document, History& history, const Baseline& baseline,
                            std::span<const ecs::Entity> entities, std::string_view component,
                            std::string_view field = {});

// ---- clipboard

// One component of an entity. Error: it has none.
Result<std::string> copyComponent(const Document& document, ecs::Entity entity, std::string_view component);
// Created entities and their like, with what hangs below, as duplicate() takes them.
Result<std::string> copyEntities(const Document& document, std::span<const ecs::Entity> entities);

enum class Pasted { Nothing, Component, Entities };
// What a text holds, so that menus can say "Paste Light".
struct Clip {
  Pasted kind = Pasted::Nothing;
  std::string component;  // of Pasted::Component
};
Clip peekClip(std::string_view text);

// Onto all of the entities. A component that a Created entity lacks is added where it may be. Errors: the
// text is no copy of ours, or damaged (names the JSON path); an entity that cannot take it.
Result<void> pasteComponent(Document& document, History& history, std::span<const ecs::Entity> entities,
                            std::string_view text);
// New entities below `parent` (none: the world). Returns the topmost of them.
Result<std::vector<ecs::Entity>> pasteEntities(Document& document, History& history, ecs::Entity parent,
                                               std::string_view text);

}  // namespace lambent::editor
