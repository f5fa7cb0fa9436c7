// Converts the strength of a local light to the units in which lamps are sold and measured, and places new
// lights. Components store candela for point and spot lights, lux for directional ones and cd/m² for spheres
// and discs (1 cd = 1 W/sr up to the global scale of all light). Main thread.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "editor/document/snapshot.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

class Session;

struct LightUnit {
  std::string_view name;  // "lm"
  std::string_view help;  // what it measures
  double factor = 1.0;    // value in this unit for each unit of the component's strength; > 0
};

// Returns the units in which this light can be given, that of the component first. Colour counts as white.
std::vector<LightUnit> unitsOf(const scene::LocalLightComponent& light);
// Returns the unit of this name, or the first if the light has none of that name.
LightUnit unitOf(const scene::LocalLightComponent& light, std::string_view name);

// Returns the point that a new entity gets: on the way from the surface in the middle of the picture to the
// camera, or the point that the camera turns about where there is no surface.
glm::vec3 newPlace(const Session& session);
// Returns a light of this kind at `at`, or at newPlace() without it. It is turned towards the surface that
// the camera looks at, and as bright as the present exposure shows well, so that it is seen at once.
EntitySnapshot newLight(const Session& session, scene::LocalLightComponent::Kind kind, std::string name,
                        const std::optional<glm::vec3>& at);

}  // namespace lambent::editor
