// Updates world matrices and rigid groups from the Transforms, once per frame. Only entities with a changed
// version cost work. Parents are updated before their children in any order of entities, and hierarchies may
// have any depth. Converts Transforms to matrices and back.
#pragma once

#include <cstddef>
#include <optional>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include "runtime/ecs/registry.hpp"

namespace lambent::scene {

struct Transform;

// Adds a WorldTransform for each Transform, and recomputes it if the Transform or the parent's matrix has a
// new version. Then updates the groups whose node's matrix has a new version. Results that do not change keep
// their version. A group that is flattened or mirrored since rest keeps its last rotation.
void updateTransforms(ecs::Registry& registry);

// Returns translation * rotation * scale * shear. The rows of shear are (1, xy, xz), (0, 1, yz) and
// (0, 0, 1).
glm::mat4 localMatrix(const Transform& transform);

// Sets translation, rotation, scale and shear so that localMatrix() returns `parent_from_node` up to
// rounding. This works for every affine matrix, also if it mirrors (scale.x < 0), shears or is singular
// (zeros in scale). The parent entity stays unchanged.
void setLocalMatrix(Transform& transform, const glm::mat4& parent_from_node);

// Returns the length of the longest column, which is the largest scale along an axis.
float largestScale(const glm::mat4& matrix);

// Returns the rotation nearest to `linear`, which is the orthogonal factor Q of `linear` = Q S with S
// symmetric and positive (Higham 1986, Newton iteration in double precision). Returns nothing if the matrix
// is singular or mirrors.
std::optional<glm::quat> polarRotation(const glm::dmat3& linear);

}  // namespace lambent::scene
