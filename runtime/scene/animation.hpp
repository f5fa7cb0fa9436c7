// Plays the animations of the bundles in a scene. This system reads AnimationComponents and writes
// Transforms. It writes and gives new versions only to Transforms that change, so an animation that is
// paused, at its end or between two equal keys costs no transforms, captures or shading. Call it before
// updateTransforms. Nodes keep their rest pose until their animation has played or its time was set.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::scene {

// Names a bundle that AnimationComponent::bundle refers to.
struct AnimatedBundle {
  std::uint32_t bundle = 0;
  const bundle::Description* description = nullptr;
  const SceneInstance* instance = nullptr;
};

// Advances the time of playing animations by `seconds` times their speed. It wraps within 0..duration if they
// loop, else it stops at the ends. Then sets the pose of animations whose time differs from that of their
// last pose. If several animations move one node, the last counts. Seconds that are not finite count as 0.
void playAnimations(ecs::Registry& registry, std::span<const AnimatedBundle> bundles, float seconds);

// Sets the time and the pose of all animations, playing or not. The last value holds beyond the last key.
void setAnimationTime(ecs::Registry& registry, std::span<const AnimatedBundle> bundles, float time_s);

}  // namespace lambent::scene
