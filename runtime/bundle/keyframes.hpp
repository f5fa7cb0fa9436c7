// Evaluates animations at a point in time, as glTF 2.0, appendix C says: step, linear (slerp for rotations)
// or cubic Hermite splines. The first value holds before the first key, the last value after the last key.
// Quaternions are returned with unit length. Times that are not finite count as 0.
#pragma once

#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/gltf_types.hpp"

namespace lambent::gltf {

// Evaluates a Translation or Scale channel.
glm::vec3 vectorAt(const AnimationChannel& channel, float time_s);
// Evaluates a Rotation channel.
glm::quat rotationAt(const AnimationChannel& channel, float time_s);

// Returns the time of the last key in seconds, or 0 if there is none.
float durationOf(const Animation& animation);

// Sets the part of a node's transform that the channel animates.
void applyChannel(const AnimationChannel& channel, float time_s, Trs& parts);

// Sets trs and parent_from_node of all animated nodes for the time. If several channels animate the same
// part, the last one counts.
void applyAnimations(std::span<const Animation> animations, float time_s, std::vector<Node>& nodes);

}  // namespace lambent::gltf
