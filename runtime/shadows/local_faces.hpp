// Defines the six faces of a shadow cube as local_shadow.glsl looks them up: +X, -X, +Y, -Y, +Z, -Z, each a
// camera along its axis with a field of view of 90 degrees. Boxes are relative to the cube's centre.
#pragma once

#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

struct FaceAxes {
  glm::vec3 right, up, forward;
};

inline FaceAxes faceAxes(std::uint32_t face) {
  glm::vec3 forward(0.0f);
  forward[static_cast<int>(face / 2)] = face % 2 == 1 ? -1.0f : 1.0f;
  const glm::vec3 up = face / 2 == 1 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
  return {glm::cross(forward, up), up, forward};
}

// Return the least and the greatest dot(axis, x) over the box.
inline float leastAlong(const scene::Box& box, glm::vec3 axis) {
  float sum = 0.0f;
  for (int i = 0; i < 3; ++i) sum += axis[i] * (axis[i] > 0.0f ? box.min[i] : box.max[i]);
  return sum;
}
inline float mostAlong(const scene::Box& box, glm::vec3 axis) {
  return -leastAlong(box, -axis);
}

// Returns whether part of the box may lie in the face's frustum; at its edges it may return true for boxes
// outside.
inline bool faceMeets(const FaceAxes& axes, const scene::Box& box) {
  for (const glm::vec3 side : {axes.right, -axes.right, axes.up, -axes.up})
    if (mostAlong(box, axes.forward + side) < 0.0f) return false;
  return true;
}

// Return the distance of the box's nearest and farthest point from the centre.
inline float nearestDistance(const scene::Box& box) {
  return glm::length(glm::max(glm::max(box.min, -box.max), glm::vec3(0.0f)));
}
inline float farthestDistance(const scene::Box& box) {
  return glm::length(glm::max(glm::abs(box.min), glm::abs(box.max)));
}

}  // namespace lambent::frame
