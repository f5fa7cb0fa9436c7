// Draws the fields of a component as widgets, a row each, for the entities that have it. Edits are steps of
// the history: a drag, or the time that a text field is open, is one. Part of the inspector.
#pragma once

#include <span>

#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

// Draws a table of all fields that are used (document/field_use.hpp). The last entity is the primary one,
// whose values are shown; edits reach all of them.
void drawFields(Session& session, Marks& marks, const scene::ComponentInfo& component,
                std::span<const ecs::Entity> entities);

// Begins a table of labels, which take this share of the width, and values. It is ended by ImGui::EndTable().
// Returns whether it is shown.
bool beginFieldTable(const char* id, float labels = 0.38f);
// Begins a row: draws its label, and goes to its value.
void beginFieldRow(std::string_view label, std::string_view help);

}  // namespace lambent::editor
