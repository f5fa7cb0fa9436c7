// Which lights that stand in the scene shine per pixel with shadow cubes, and how much of each: those that
// stand within the bounds of a group, and those that stand beside one, nearer to its middle than so many of
// its radii. On the way out of that distance the share falls to 0 bit by bit. No GL.
#pragma once

#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/lighting/local_light.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

// Whether a light that stands in the scene is within a group's bounds, which are in its frame.
bool standsWithin(const scene::Box& bounds, const glm::mat4& world_from_group,
                  const lighting::LocalLight& light);

// How far such a light is from the middle of a group's bounds, in radii of these: 0 within the bounds, more
// outside, infinite where that means nothing.
float radiiFrom(const scene::Box& bounds, const glm::mat4& world_from_group,
                const lighting::LocalLight& light);

// Of each light its share, 0 to 1, by radiiFrom() the group that it is nearest to. Lights within bounds have
// all of it. No more than kMaxShadowedLights have any: where more stand within `radii`, the first that has no
// room sets the distance, so that nothing jumps where two lights change places.
std::vector<float> localShares(std::span<const float> radii_from, float radii);

}  // namespace lambent::frame
