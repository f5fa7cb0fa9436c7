// Several scenes as one, each where it stands in the world: for a picture of all that is shown together.
#pragma once

#include <string>

#include <glm/mat4x4.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker {

// Adds all of `from` to the end of `to`, below a node of this name at `world_from_scene`. What stood in `to`
// keeps its indices. The source stays that of `to`.
void joinScene(Scene from, const std::string& name, const glm::mat4& world_from_scene, Scene& to);

}  // namespace lambent::baker
