// Chooses which lights in the scene are shaded per pixel with shadow cubes, and with what share: those within
// the bounds of a group, and those beside one, within a given number of its radii from its centre. Near that
// distance the share falls to 0 continuously. No GL.
#pragma once

#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/lighting/local_light.hpp"
#include "runtime/scene/bounds.hpp"

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

}  // namespace lambent::frame
