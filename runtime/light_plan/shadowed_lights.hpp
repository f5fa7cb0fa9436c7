// Chooses which lights in the scene are shaded per pixel with shadow cubes, and with what share: those within
// the bounds of a group, and those beside one, within a given number of its radii from its centre. Near that
// distance the share falls to 0 continuously. No GL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/lighting/local_light.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

// Returns whether a light in the scene is within a group's bounds, which are given in the group's frame.
bool standsWithin(const scene::Box& bounds, const glm::mat4& world_from_group,
                  const lighting::LocalLight& light);

// Returns the distance of such a light from the centre of a group's bounds in units of their radius: 0 within
// the bounds, larger outside, infinite if it is undefined.
float radiiFrom(const scene::Box& bounds, const glm::mat4& world_from_group,
                const lighting::LocalLight& light);

// Returns the share of each light, 0..1, given the least radiiFrom() over all groups. Lights within bounds
// have share 1. At most kMaxShadowedLights have a share: if more stand within `radii`, the distance of the
// first one without a cube becomes the limit, so that nothing jumps when two lights change places.
std::vector<float> localShares(std::span<const float> radii_from, float radii);

// Chooses which of the groups' own lights are shaded per pixel: column lights whose shape is known, as far as
// there are shadow cubes. Point and spot lights at nodes, and emissive materials that shine as a few spheres,
// have a known shape. All other column lights, and those without a cube, shine by their columns alone. No GL.

// Describes a column light that a shadow cube, or one for each of its spheres, can show.
struct ColumnLight {
  std::size_t group = 0;  // of the residency
  std::uint32_t column = 0;
  bool material = false;
  ecs::Entity entity{};  // of the light, or of the lamp of the material
  std::vector<lighting::LocalLight> shapes;
};

// Returns the column lights of all groups of surfaces that shine now, stand in their places and have a known
// shape. A group that was scaled since the bake has none, because its columns do not know of that.
std::vector<ColumnLight> findColumnLights(const World& world);

// Returns the intensity of a light, as luminance in candela.
float intensityOf(const lighting::LocalLight& light);

// Returns about what each light brings to the picture: its mean irradiance over what the camera sees of the
// bounds of its group, as if nothing was in the way. Without a camera it is the light's intensity.
std::vector<float> effectsOf(const World& world, std::span<const ColumnLight> lights);

// Returns the indices, rising, of those lights that get shadow cubes, of which `cubes` are free: those with
// the greatest effect, each only if there are cubes for all of its shapes. A light whose entity is in
// `before` keeps its cubes until another one is clearly greater.
std::vector<std::size_t> chooseColumnLights(std::span<const ColumnLight> lights,
                                            std::span<const float> effects, std::size_t cubes,
                                            std::span<const ecs::Entity> before = {});

}  // namespace lambent::frame
