// Animations at a point in time: glTF 2.0, appendix C (step, linear with slerp for rotations, cubic Hermite
// splines). Before the first key the first value holds, after the last the last. Quaternions come out unit;
// times that are not finite count as 0.
#pragma once

#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/gltf_types.hpp"

namespace lambent::gltf {

// Translation and Scale channels.
glm::vec3 vectorAt(const AnimationChannel& channel, float time_s);
// Rotation channels.
glm::quat rotationAt(const AnimationChannel& channel, float time_s);

// From 0 to its last key; 0 if it has none.
float durationOf(const Animation& animation);

// Puts what the channels name into the parts of a node.
void applyChannel(const AnimationChannel& channel, float time_s, Trs& parts);

// Moves the nodes that the animations name to where they are at time_s: trs and parent_from_node. Where
// several move the same, the last counts.
void applyAnimations(std::span<const Animation> animations, float time_s, std::vector<Node>& nodes);

}  // namespace lambent::gltf
