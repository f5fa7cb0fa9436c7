// Plays the animations of the bundles in a scene: a system over AnimationComponents that writes Transforms.
// Comes in: the registry, the bundles' descriptions and entities, seconds since the last call. Goes out:
// Transforms of the nodes that stand elsewhere now, and only theirs get new versions: an animation that is
// paused, at its end or between two equal keys costs no transform, capture or shading. Run it before
// updateTransforms. Until an animation has played or its time was set, its nodes stand at rest.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::scene {

// What AnimationComponent::bundle names.
struct AnimatedBundle {
  std::uint32_t bundle = 0;
  const bundle::Description* description = nullptr;
  const SceneInstance* instance = nullptr;
};

struct AnimationUpdates {
  std::uint32_t animations = 0;  // at another time than before
  std::uint32_t nodes = 0;       // that stand elsewhere now
};

// Moves the time of those that play by `seconds` times their speed: around in 0..duration where they loop,
// else up to its ends; then poses what is at another time than it was posed for. Where several animations
// move one node, the last counts. Seconds that are not finite count as 0.
AnimationUpdates playAnimations(ecs::Registry& registry, std::span<const AnimatedBundle> bundles,
                                float seconds);

// Puts all of them to time_s and poses them, playing or not. Beyond the last key the last value holds.
AnimationUpdates setAnimationTime(ecs::Registry& registry, std::span<const AnimatedBundle> bundles,
                                  float time_s);

}  // namespace lambent::scene
