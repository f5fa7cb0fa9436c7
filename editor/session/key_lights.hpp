// Lists the environment's key lights with their direction, strength and source, and moves, dims and tints
// them. A key light from an environment map is edited by a word in WorldState::key_edits, one from a sun by
// changing the sun's word. Each edit is a step of the history. Angles are in world space: azimuth 0 is +Z
// and 90 is +X, as for cameras. Errors: there is no such key light, or it cannot be edited in this way.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

class Session;
struct WorldState;

struct KeyLight {
  std::size_t set = 0;  // 0: one of the lights; 1: one of the lights that are faded to
  // Index in WorldState::lights (or fade_lights) of the light in which it was found, and that light's word.
  std::size_t light = 0;
  std::string word;
  bool in_map = false;
  bool piece = false;   // part of a wide sun that was divided
  bool edited = false;  // has an edit of its own
  glm::vec3 towards_ws{0.0f, 1.0f, 0.0f};
  float azimuth_deg = 0.0f, elevation_deg = 0.0f, radius_deg = 0.0f;
  glm::vec3 radiance{0.0f};  // at present, with edits
  glm::vec3 factor{1.0f};    // of `radiance` to what was found
  double share = 0.0;        // of the luminous flux of all distant lights

  std::string source() const;  // "studio.hdr", "sun 1", "piece of sun 1"
};

std::vector<KeyLight> keyLightsOf(const Session& session);

// Turns a key light to this direction in world space. If it is a piece of a sun, the whole sun turns.
Result<void> moveKeyLight(Session& session, std::size_t key, const glm::vec3& towards_ws);
// Scales the radiance: sets the factor on a key light from an environment map, or multiplies the radiance of
// a sun. The range per channel is 0 to 10^6.
Result<void> dimKeyLight(Session& session, std::size_t key, const glm::vec3& factor);
// Removes the edits of one key light, or of all without a number. Suns are not changed.
Result<void> resetKeyLights(Session& session, std::optional<std::size_t> key);

std::string sunWord(const spec::SunLight& sun);
bool isEnvironmentMap(const std::string& word);
// Sets the world's lights. Edits of key lights stay with their environment maps, and are removed with them.
void replaceLights(const Session& session, WorldState& world, std::vector<std::string> lights);

}  // namespace lambent::editor
