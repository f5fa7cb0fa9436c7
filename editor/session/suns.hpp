// Finds the suns of what is selected and drags them over the sky: those of the environment's light words, key
// lights that were found in its environment maps, and lights from one direction that stand in the tree. A sun
// that moves is an edit like any other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/ecs/registry.hpp"

namespace lambent::editor {

class Session;

struct SunOnSky {
  std::string name;
  std::optional<std::size_t> light;  // of WorldState::lights; else
  std::optional<std::size_t> key;    // of Environment::keys(), found in an environment map; else
  ecs::Entity entity;                // with a directional light
  glm::vec3 towards_ws{0.0f, 1.0f, 0.0f};
  glm::mat4 world_from_node{1.0f};  // of the entity
};

std::vector<SunOnSky> sunsOf(const Session& session);
// Moves a sun from where it stood at the press (`start`), so that a drag that comes back brings back what was
// there.
void moveSun(Session& session, const SunOnSky& start, const glm::vec3& towards_ws);
// Returns "azimuth 35.0, elevation 45.0": the angles of its word, or of a key light in the world.
std::string sunReadout(const Session& session, const SunOnSky& sun);

}  // namespace lambent::editor
