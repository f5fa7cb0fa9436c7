// Draws the fields of a component as widgets, a row each, for the entities that have it. Edits are steps of
// the history: a drag, or the time that a text field is open, is one. Part of the inspector.
#pragma once

#include <span>

#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

// Draws a table of the fields that all entities use (document/field_edits.hpp). Values that differ are shown
// as a dash. An edit reaches all entities: a drag shifts their numbers by the same amount, and those of
// lights' strength by the same factor; what is typed or chosen sets all alike. The last entity is the primary
// one.
void drawFields(Session& session, Marks& marks, const scene::ComponentInfo& component,
                std::span<const ecs::Entity> entities);

// Begins a table of labels, which take this share of the width, and values. It is ended by ImGui::EndTable().
// Returns whether it is shown.
bool beginFieldTable(const char* id, float labels = 0.38f);
// Begins a row: draws its label, and goes to its value.
void beginFieldRow(std::string_view label, std::string_view help);

// Makes one step of the history from a drag of the widget that was drawn last.
void asOneStep(Session& session, const char* name);
// Logs why an edit was refused, if it was.
void logRefusal(Session& session, const Result<void>& done);

}  // namespace lambent::editor
