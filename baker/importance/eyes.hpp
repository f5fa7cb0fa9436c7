// Places eyes: points from which pictures of a rigid group are likely to be taken. Half of all pictures are
// those of the file's cameras; the other half is taken from the connected free space in which these stand.
// Without cameras, eyes stand in the rooms of the group, around the whole of it, and around its parts, so
// that small bodies are seen from near by, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

struct Eye {
  enum class View : std::uint8_t { AllAround, Cone, Frustum };

  glm::vec3 position{0.0f};  // as GroupGeometry::positions
  float weight = 0.0f;       // the share of all pictures that are taken from here
  View view = View::AllAround;
  glm::mat3 axes{1.0f};                      // right, up and backward
  float tangent_x = 0.0f, tangent_y = 0.0f;  // of half the angle of a frustum
  float cone_cosine = -1.0f;                 // of half the angle of a cone

  // Returns the unit direction of ray i of a low-discrepancy sequence that covers the view.
  glm::vec3 direction(std::size_t i) const;
  // Returns the rays per steradian around a unit direction, for one ray in all; 0 outside the view.
  float density(const glm::vec3& direction) const;
};

// Returns the file's cameras as eyes of the group at rest.
std::vector<Eye> cameraEyes(const Scene& scene, const RigidGroup& group, const GroupGeometry& geometry);

// Adds the cameras' eyes to the key of a result that depends on them.
void addEyes(std::span<const Eye> eyes, KeyMaker& key);

// Returns all eyes that see anything; their weights sum to 1. `cameras` are those of cameraEyes().
std::vector<Eye> placeEyes(const GroupGeometry& geometry, const RayScene& rays, std::vector<Eye> cameras);

// Returns the i-th number of van der Corput in this base, 0..1.
float radicalInverse(std::size_t i, std::size_t base);

}  // namespace lambent::baker
