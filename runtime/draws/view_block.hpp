// The uniform block of the camera, as surface.vert and the shaders that draw over its picture read it.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace lambent::frame {

struct ViewBlock {
  glm::mat4 view_from_world, clip_from_view;
  glm::vec4 eye;  // see glossy_receiver.glsl
};

}  // namespace lambent::frame
