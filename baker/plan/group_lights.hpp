// Finds out whether an emissive material shines as a few spheres, such as bulbs and glowing balls. The direct
// light of spheres can be shaded per pixel, which shows the sharp shadows that values at vertices blur. What
// a scene's material emits in a rigid group comes in, spheres in the group's frame come out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// Numbers the corners of triangles by place, so that triangles tell which of them meet. Vertices at seams of
// texture coordinates and normals, and at the poles of spheres, stand at one place but for rounding: those
// nearer to each other than a share of the diagonal of all positions are one corner.
struct CornerNumbers {
  std::vector<std::uint32_t> of;  // of each position; empty if all are at one place
  std::vector<glm::vec3> places;  // by their numbers
};
CornerNumbers cornerNumbers(std::span<const glm::vec3> positions);

// Returns the spheres, at most bundle::kMaxLampSpheres, or nothing if the material has an emissive texture or
// if any part of its surfaces in the group is not about a sphere that is closed and emits outwards.
std::vector<bundle::LampSphere> findLampSpheres(const Scene& scene, const RigidGroup& group,
                                                std::uint32_t material);

// Finds the lights that belong to a rigid group: emissive materials on its surfaces, and point and spot
// lights on nodes that move with it. Light from infinity cannot describe them, so each becomes a column of
// the group's transfer at unit strength, and can be dimmed and recoloured live.

struct PlannedLight {
  enum class Kind : std::uint8_t { Material, Node };
  Kind kind = Kind::Material;
  std::uint32_t index = 0;  // into the scene's materials or nodes
  glm::vec3 color{1.0f};    // strength as in the file: radiance, or colour x intensity of a punctual light
  glm::mat4 group_from_node{1.0f};  // used for punctual lights only
  // Used for materials only: the spheres as which it emits, if it does.
  std::vector<bundle::LampSphere> spheres{};
};

// Returns materials first, in the order of the draws, then nodes in their own order.
std::vector<PlannedLight> findGroupLights(const Scene& scene, const RigidGroup& group);

// Returns which of a group's lights are shaded per pixel by shadow cubes: those whose shape is known, if
// there are enough cubes for all of them. Values at vertices bring only what the others send directly.
std::vector<bool> shadedPerPixel(std::span<const PlannedLight> lights);

// Returns the node at or above `node` that starts its rigid group, or -1 for the static group.
std::int32_t groupRootOf(const Scene& scene, std::uint32_t node);

}  // namespace lambent::baker
