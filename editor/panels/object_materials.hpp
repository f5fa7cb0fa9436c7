// Draws what an object is made of: its materials with pictures and fields, and what a primitive is. Part of
// the inspector.
#pragma once

#include "editor/session/session.hpp"
#include "editor/ui/marks.hpp"

namespace lambent::editor {

// Draws nothing for an entity without draws.
void drawObjectMaterials(Session& session, Marks& marks, ecs::Entity object);
void drawPrimitive(Session& session, Marks& marks, ecs::Entity draw);
// Draws a sphere of the material, and its textures.
void drawMaterialPictures(Session& session, Marks& marks, ecs::Entity material);

}  // namespace lambent::editor
