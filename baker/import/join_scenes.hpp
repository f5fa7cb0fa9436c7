// Joins several scenes into one, each at its place in the world, for a picture of everything that is shown.
#pragma once

#include <string>

#include <glm/mat4x4.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker {

// Appends all of `from` to `to`, below a new node called `name` at `world_from_scene`. Indices and the source
// of `to` stay unchanged.
void joinScene(Scene from, const std::string& name, const glm::mat4& world_from_scene, Scene& to);

}  // namespace lambent::baker
