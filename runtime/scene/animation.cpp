#include "runtime/scene/animation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::scene {
namespace {

const AnimatedBundle* bundleOf(std::span<const AnimatedBundle> bundles, const AnimationComponent& player) {
  const auto found = std::ranges::find(bundles, player.bundle, &AnimatedBundle::bundle);
  return found != bundles.end() && player.animation < found->description->animations.size() ? &*found
                                                                                            : nullptr;
}

// Returns the time of an animation after `seconds` of its own time. If the user has set a time outside
// 0..duration and it does not loop, it is not clamped but may come back by itself.
float advanced(float time, float seconds, float duration, bool loop) {
  if (!(duration > 0.0f) || seconds == 0.0f) return time;
  const float next = (std::isfinite(time) ? time : 0.0f) + seconds;
  if (!loop) {
    const float low = std::min(0.0f, time), high = std::max(duration, time);
    return std::clamp(next, low, high);
  }
  if (next >= 0.0f && next < duration) return next;
  const float within = std::fmod(next, duration);
  return within < 0.0f ? within + duration : within;
}

// Writes the pose at the player's time. Nodes that have this pose already are not touched.
void pose(ecs::Registry& registry, const AnimatedBundle& bundle, AnimationComponent& player) {
  for (const gltf::AnimationChannel& channel : bundle.description->animations[player.animation].channels) {
    const ecs::Entity node = bundle.instance->nodes[channel.node];
    const Transform* now = registry.tryGet<Transform>(node);
    if (!now) continue;  // the node was removed from the scene
    gltf::Trs parts{.translation = now->translation, .rotation = now->rotation, .scale = now->scale};
    const gltf::Trs before = parts;
    gltf::applyChannel(channel, player.time_s, parts);
    if (parts == before) continue;
    Transform& transform = registry.edit<Transform>(node);
    transform.translation = parts.translation;
    transform.rotation = parts.rotation;
    transform.scale = parts.scale;
  }
  player.posed_s = player.time_s;
}

}  // namespace

void playAnimations(ecs::Registry& registry, std::span<const AnimatedBundle> bundles, float seconds) {
  if (!std::isfinite(seconds)) seconds = 0.0f;
  for (auto [entity, player] : registry.view<AnimationComponent>()) {
    const AnimatedBundle* bundle = bundleOf(bundles, player);
    if (!bundle) continue;
    if (player.playing && std::isfinite(player.speed)) {
      const float duration = gltf::durationOf(bundle->description->animations[player.animation]);
      const float time = advanced(player.time_s, seconds * player.speed, duration, player.loop);
      if (time != player.time_s) {
        player.time_s = time;
        registry.touch<AnimationComponent>(entity);
      }
    }
    if (player.time_s == player.posed_s || std::isnan(player.time_s)) continue;
    pose(registry, *bundle, player);
  }
}

void setAnimationTime(ecs::Registry& registry, std::span<const AnimatedBundle> bundles, float time_s) {
  if (!std::isfinite(time_s)) time_s = 0.0f;
  for (auto [entity, player] : registry.view<AnimationComponent>()) {
    const AnimatedBundle* bundle = bundleOf(bundles, player);
    if (!bundle) continue;
    if (time_s != player.time_s) {
      player.time_s = time_s;
      registry.touch<AnimationComponent>(entity);
    }
    pose(registry, *bundle, player);
  }
}

}  // namespace lambent::scene
