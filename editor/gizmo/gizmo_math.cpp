// Computes what a drag does to one target.
#include <cmath>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "editor/gizmo/gizmo.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::editor {
namespace {

// Returns whether the parent only rotates, mirrors and scales uniformly, so that a rotation stays a rotation.
bool isSimilarity(const glm::dmat3& linear) {
  const glm::dmat3 square = glm::transpose(linear) * linear;
  const double size = (square[0][0] + square[1][1] + square[2][2]) / 3.0;
  if (!(size > 0.0)) return false;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double expected = column == row ? size : 0.0;
      if (std::abs(square[column][row] - expected) > 1e-5 * size) return false;
    }
  }
  return true;
}

bool invertible(const glm::dmat3& linear) {
  const double volume = std::abs(glm::determinant(linear));
  const double size = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  return volume > 1e-12 * size && size > 0.0;
}

// Returns the moved Transform with the target's matrix multiplied by `linear`, whose shear it stores.
scene::Transform transformedBy(const GizmoTarget& target, scene::Transform moved, const glm::dmat3& linear) {
  glm::dmat4 matrix(scene::localMatrix(target.local));
  for (int column = 0; column < 3; ++column)
    matrix[column] = glm::dvec4(linear * glm::dvec3(matrix[column]), 0.0);
  const glm::vec3 translation = moved.translation;
  scene::setLocalMatrix(moved, glm::mat4(matrix));
  moved.translation = translation;
  return moved;
}

}  // namespace

glm::dvec3 originOf(const GizmoTarget& target) {
  return glm::dvec3(glm::dmat4(target.world_from_parent) * glm::dvec4(target.local.translation, 1.0));
}

glm::dmat3 axesOf(const GizmoTarget& target) {
  glm::dmat3 axes(glm::dmat4(target.world_from_parent) * glm::dmat4(scene::localMatrix(target.local)));
  for (int i = 0; i < 3; ++i) {
    const double length = glm::length(axes[i]);
    if (!(length > 0.0)) return glm::dmat3(1.0);
    axes[i] /= length;
  }
  // A node that is nearly flat by its shear has no usable axes.
  return std::abs(glm::determinant(axes)) > 1e-3 ? axes : glm::dmat3(1.0);
}

scene::Transform movedBy(const GizmoTarget& target, const glm::dvec3& delta_ws) {
  scene::Transform moved = target.local;
  const glm::dmat3 linear{glm::mat3(target.world_from_parent)};
  if (!invertible(linear)) return moved;  // a flat parent has no inverse
  moved.translation = glm::vec3(glm::dvec3(target.local.translation) + glm::inverse(linear) * delta_ws);
  return moved;
}

scene::Transform turnedBy(const GizmoTarget& target, const glm::dvec3& pivot_ws, const glm::dvec3& axis_ws,
                          double angle_rad) {
  const glm::dmat3 linear{glm::mat3(target.world_from_parent)};
  if (!invertible(linear)) return target.local;
  const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), angle_rad, axis_ws));
  const glm::dvec3 origin = originOf(target);
  scene::Transform turned = movedBy(target, pivot_ws + turn * (origin - pivot_ws) - origin);
  const glm::dmat3 parent_turn = glm::inverse(linear) * turn * linear;
  if (isSimilarity(linear)) {
    // The result is a rotation again; scale and shear stay.
    turned.rotation = glm::quat(
        glm::normalize(glm::quat_cast(parent_turn) * glm::normalize(glm::dquat(target.local.rotation))));
    return turned;
  }
  return transformedBy(target, turned, parent_turn);
}

scene::Transform scaledLocally(const GizmoTarget& target, const glm::dvec3& pivot_ws, const glm::dmat3& axes,
                               const glm::dvec3& factors) {
  const glm::dvec3 origin = originOf(target);
  const glm::dvec3 place = pivot_ws + axes * (factors * (glm::inverse(axes) * (origin - pivot_ws)));
  scene::Transform scaled = movedBy(target, place - origin);
  scaled.scale = glm::vec3(glm::dvec3(target.local.scale) * factors);
  // The columns are scaled, so the shear terms change by the ratio of two factors.
  const glm::dvec3 f = factors;
  if (f.x != 0.0 && f.y != 0.0) {
    scaled.shear.x = static_cast<float>(target.local.shear.x * f.y / f.x);
    scaled.shear.y = static_cast<float>(target.local.shear.y * f.z / f.x);
    scaled.shear.z = static_cast<float>(target.local.shear.z * f.z / f.y);
  }
  return scaled;
}

scene::Transform scaledInWorld(const GizmoTarget& target, const glm::dvec3& pivot_ws,
                               const glm::dvec3& factors) {
  const glm::dmat3 linear{glm::mat3(target.world_from_parent)};
  if (!invertible(linear)) return target.local;
  const glm::dvec3 origin = originOf(target);
  const scene::Transform scaled = movedBy(target, pivot_ws + factors * (origin - pivot_ws) - origin);
  glm::dmat3 stretch(1.0);
  for (int axis = 0; axis < 3; ++axis) stretch[axis][axis] = factors[axis];
  return transformedBy(target, scaled, glm::inverse(linear) * stretch * linear);
}

}  // namespace lambent::editor
