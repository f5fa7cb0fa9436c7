// The camera as draws know it: its uniform block, and what it cannot show.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

// The uniform block of the camera, as surface.vert and the shaders that draw over its picture read it.
struct ViewBlock {
  glm::mat4 view_from_world, clip_from_view;
  glm::vec4 eye;  // see glossy_receiver.glsl
};

// Tells what a view cannot show because it lies beside, before or behind what the camera sees.

// Returns whether all of the box lies on the far side of one plane of the frustum. A box that surrounds a
// corner of the frustum may be outside and still count as in view.
inline bool outOfView(const glm::mat4& clip_from_box, const scene::Box& box) {
  constexpr float kMargin = 1.0001f;  // for rounding
  int beyond[6] = {};                 // corners beyond each plane
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec4 clip =
        clip_from_box * glm::vec4(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                  corner & 4 ? box.max.z : box.min.z, 1.0f);
    for (int axis = 0; axis < 3; ++axis) {
      beyond[2 * axis] += clip[axis] > kMargin * clip.w;
      beyond[2 * axis + 1] += -clip[axis] > kMargin * clip.w;
    }
  }
  for (const int corners : beyond)
    if (corners == 8) return true;
  return false;
}

}  // namespace lambent::frame
