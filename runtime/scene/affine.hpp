// Affine matrices taken apart and put together: Transform <-> matrix, and the rotation in a motion.
#pragma once

#include <optional>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

namespace lambent::scene {

struct Transform;

// translation * rotation * scale * shear, the shear being ((1, xy, xz), (0, 1, yz), (0, 0, 1)) by rows.
glm::mat4 localMatrix(const Transform& transform);

// Sets translation, rotation, scale and shear so that localMatrix() is `parent_from_node` again, up to
// rounding, for every affine matrix: mirrored (scale.x < 0), sheared or singular (zeros in scale). The parent
// stays.
void setLocalMatrix(Transform& transform, const glm::mat4& parent_from_node);

// How much it stretches at most along an axis of its frame.
float largestScale(const glm::mat4& matrix);

// The orthogonal factor of `linear` = Q S, S symmetric and positive: the rotation nearest to it (Higham 1986,
// Newton iteration in double). None where the matrix is singular or mirrors.
std::optional<glm::quat> polarRotation(const glm::dmat3& linear);

}  // namespace lambent::scene
