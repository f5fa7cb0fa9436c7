// Holds the angles of the rotation that a field shows. Many angles give one rotation, so a field that made
// them anew from the rotation in each frame would jump to others while it is dragged beyond 90 degrees.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace lambent::editor {

struct HeldAngles {
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 degrees{0.0f};
};

}  // namespace lambent::editor
