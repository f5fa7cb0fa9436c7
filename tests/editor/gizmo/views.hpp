// Makes views to drag things in: perspective and orthographic, near the origin and far from it.
#pragma once

#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "editor/gizmo/projection.hpp"

namespace lambent::editor::testing {

inline constexpr Viewport kViewport{40.0f, 20.0f, 800.0f, 600.0f};

inline spec::View lookAt(glm::vec3 eye, glm::vec3 at, bool perspective) {
  spec::View view;
  view.eye_ws = eye;
  const float distance = glm::length(at - eye);
  const glm::vec3 way = (at - eye) / distance;
  const glm::vec3 up = std::abs(way.y) > 0.99f ? glm::vec3(0.0f, 0.0f, -1.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
  view.view_from_world = glm::lookAt(eye, at, up);
  const float aspect = kViewport.width / kViewport.height, half = 0.4f * distance;
  view.clip_from_view = perspective
                            ? glm::perspective(0.7f, aspect, 0.1f, 10.0f * distance)
                            : glm::ortho(-half * aspect, half * aspect, -half, half, 0.1f, 10.0f * distance);
  return view;
}

}  // namespace lambent::editor::testing
