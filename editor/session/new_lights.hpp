// Places new lights so that they are seen at once: in front of the surface that the camera looks at, turned
// towards it, and as bright as the present exposure shows well. Main thread.
#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "editor/document/snapshot.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

class Session;

// Returns the point that a new entity gets: on the way from the surface in the middle of the picture to the
// camera, or the point that the camera turns about where there is no surface.
glm::vec3 newPlace(const Session& session);
// Returns a light of this kind at `at`, or at newPlace() without it.
EntitySnapshot newLight(const Session& session, scene::LocalLightComponent::Kind kind, std::string name,
                        const std::optional<glm::vec3>& at);

}  // namespace lambent::editor
