// Finds the suns that can be dragged over the sky: suns of the environment's light words, key lights that
// were found in its environment maps, and directional lights of the scene. Moving one is an edit like any
// other.
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
  // Exactly one of these three is set: an index into WorldState::lights, an index into Environment::keys() (a
  // key light of an environment map), or an entity with a directional light.
  std::optional<std::size_t> light;
  std::optional<std::size_t> key;
  ecs::Entity entity;
  glm::vec3 towards_ws{0.0f, 1.0f, 0.0f};
  glm::mat4 world_from_node{1.0f};  // of `entity`
};

std::vector<SunOnSky> sunsOf(const Session& session);
// Moves a sun. `start` is the sun at the press, so a drag back to its start restores the exact value.
void moveSun(Session& session, const SunOnSky& start, const glm::vec3& towards_ws);
// Returns for example "azimuth 35.0, elevation 45.0": the angles of the sun's word, or those of a key light
// in world space.
std::string sunReadout(const Session& session, const SunOnSky& sun);

}  // namespace lambent::editor
