// Lists the key lights that the environment has (where each stands, how strong it is, where it was found),
// and moves, dims and colours them. Those that were found in an environment map are edited by words of
// WorldState::key_edits; those of a sun by the sun's own word. Each edit is a step of the history. Angles are
// those of the world: azimuth 0 on +Z, 90 on +X, as cameras have them. Errors: no such key light; one that
// cannot be edited so.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;
struct WorldState;

struct KeyLight {
  std::size_t set = 0;  // 1: of the lights that are faded to
  // The word of WorldState::lights (or fade_lights) in which it was found, and its place there.
  std::size_t light = 0;
  std::string word;
  bool in_map = false;
  bool piece = false;   // of a wide sun that was divided
  bool edited = false;  // has an edit of its own
  glm::vec3 towards_ws{0.0f, 1.0f, 0.0f};
  float azimuth_deg = 0.0f, elevation_deg = 0.0f, radius_deg = 0.0f;
  glm::vec3 radiance{0.0f};  // now
  glm::vec3 factor{1.0f};    // of what was found
  double share = 0.0;        // of all luminous flux from infinity

  std::string source() const;  // "studio.hdr", "sun 1", "piece of sun 1"
};

// Returns them in the order of Environment::keys().
std::vector<KeyLight> keyLightsOf(const Session& session);

// Turns it to this direction of the world. A piece of a sun takes its sun along.
Result<void> moveKeyLight(Session& session, std::size_t key, const glm::vec3& towards_ws);
// Sets the factor on what was found in an environment map, or multiplies what a sun has; per channel, 0 to a
// million.
Result<void> dimKeyLight(Session& session, std::size_t key, const glm::vec3& factor);
// Makes a key light as it was found, or all of them without a number. Suns stay as they are.
Result<void> resetKeyLights(Session& session, std::optional<std::size_t> key);

// Gives the world these lights: edits of key lights stay with the environment maps that they were found
// in, and go with them.
void replaceLights(const Session& session, WorldState& world, std::vector<std::string> lights);

}  // namespace lambent::editor
