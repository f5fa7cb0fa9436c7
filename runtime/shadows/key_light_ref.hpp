// This is the CPU twin of key_light.glsl, with the same names and order of terms, so that a test can compare
// the two. The shadow map is read through `Map`: float keyDepth(glm::ivec2 texel), 0..1, and glm::vec2
// keyBlockers(glm::ivec2 texel, int level), the least and greatest depth. No GL.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/shadows/key_shared.h"
#include "runtime/shadows/shadowed_light.hpp"

namespace lambent::frame::ref {

inline constexpr float kKeyBiasTexels = 1.0f;
inline constexpr float kDoubtfulBias = 0.25f, kTexelsAside = 1.5f;
inline constexpr float kLeastFacing = 0.02f;
inline constexpr float kSharpTexels = 0.8f;
inline constexpr float kOneHeight = 0.1f;
inline constexpr int kLeastSearch = 20;
inline constexpr int kKeySteps = 3;
inline constexpr int kKeyBetween = 5;
inline constexpr float kLowestBetween = 0.03f, kHighestBetween = 0.6f;
inline constexpr float kKeySolid = 1.5f;
inline constexpr int kKeyNarrowing = 3;
inline constexpr int kRayBlocked = 0, kRayUnsure = 1, kRayFree = 2;

struct KeyReceiver {
  glm::vec2 place;
  float depth;
  glm::vec2 slope;
  float bias;
  bool above;
};

inline KeyReceiver keyReceiver(const KeyRecord& key, glm::vec3 position, glm::vec3 normal) {
  KeyReceiver receiver;
  receiver.place = {glm::dot(glm::vec3(key.right), position) + key.right.w,
                    glm::dot(glm::vec3(key.up), position) + key.up.w};
  receiver.depth = key.towards.w - glm::dot(glm::vec3(key.towards), position);
  const float facing = glm::dot(normal, glm::vec3(key.towards));
  const glm::vec2 scale(key.scale);
  const glm::vec2 along =
      glm::vec2(glm::dot(normal, glm::vec3(key.right)), glm::dot(normal, glm::vec3(key.up))) /
      (scale * scale);
  receiver.slope = along / std::max(facing, kLeastFacing);
  receiver.bias = kKeyBiasTexels / std::min(key.scale.x, key.scale.y) + 1e-6f * key.scale.z;
  receiver.above = facing >= key.radiance.w;
  return receiver;
}

// Takes the least texel for a place that is no number.
inline glm::ivec2 nearestTexel(glm::vec2 place, glm::vec2 least, glm::vec2 most) {
  return glm::ivec2(glm::min(glm::max(least, glm::floor(place)), most));
}

template <typename Map>
glm::vec2 blockerBounds(const Map& map, const KeyRecord& key, glm::vec2 place, glm::vec2 reach) {
  const float widest = std::max(reach.x, reach.y) * 2.0f / static_cast<float>(kBlockerTexels);
  const float tile = key.tile.z - key.tile.x + 1.0f;
  const int last = static_cast<int>(std::log2(tile / static_cast<float>(kBlockerTexels)) + 0.5f);
  const int level =
      std::clamp(static_cast<int>(std::ceil(std::log2(std::clamp(widest, 1.0f, tile)))), 0, last);
  const auto texels = static_cast<float>(kBlockerTexels << level);
  const glm::vec2 least = glm::floor(glm::vec2(key.tile) / texels),
                  most = glm::floor(glm::vec2(key.tile.z, key.tile.w) / texels);
  const glm::ivec2 from = nearestTexel((place - reach) / texels, least, most);
  const glm::ivec2 to = nearestTexel((place + reach) / texels, glm::vec2(from), most);
  glm::vec2 bounds = map.keyBlockers(from, level);
  for (int i = 1; i < 4; ++i) {
    const glm::ivec2 texel((i & 1) == 1 ? to.x : from.x, i >> 1 == 1 ? to.y : from.y);
    if (texel == from) continue;
    const glm::vec2 other = map.keyBlockers(texel, level);
    bounds = {std::min(bounds.x, other.x), std::max(bounds.y, other.y)};
  }
  return key.scale.z * bounds;
}

template <typename Map>
float blockerHeight(const Map& map, const KeyRecord& key, const KeyReceiver& receiver, glm::vec2 place) {
  const glm::ivec2 texel = nearestTexel(place, glm::vec2(key.tile), glm::vec2(key.tile.z, key.tile.w));
  const float depth = key.scale.z * map.keyDepth(texel);
  const float falls = glm::dot(receiver.slope, glm::vec2(texel) + 0.5f - receiver.place);
  const float limit = receiver.depth + std::min(falls, 0.0f) - receiver.bias;
  return depth < limit ? receiver.depth - depth : 0.0f;
}

template <typename Map>
glm::vec2 texelShares(const Map& map, const KeyRecord& key, const KeyReceiver& receiver, glm::vec2 place) {
  const glm::vec2 corner = glm::floor(place - 0.5f), part = place - 0.5f - corner;
  glm::vec2 shares(0.0f);
  for (int i = 0; i < 4; ++i) {
    const glm::vec2 side(static_cast<float>(i & 1), static_cast<float>(i >> 1));
    const glm::vec2 share = side * part + (1.0f - side) * (1.0f - part);
    const bool visible = blockerHeight(map, key, receiver, corner + side) == 0.0f;
    shares[visible ? 0 : 1] += share.x * share.y;
  }
  return shares;
}

inline glm::vec2 keyPoint(int i, int count) {
  const float angle = 2.39996323f * static_cast<float>(i);
  return std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count)) *
         glm::vec2(std::cos(angle), std::sin(angle));
}

struct KeyLayers {
  float low, high;
};

template <typename Map>
KeyLayers keyLayers(const Map& map, const KeyRecord& key, const KeyReceiver& receiver, float reach,
                    int count) {
  float found = 0.0f;
  glm::vec3 powers(0.0f);
  for (int i = 0; i < count; ++i) {
    glm::vec2 at = keyPoint(i, count);
    at *= i == 0 ? 0.0f : glm::length(at) * glm::length(at);
    const float height =
        blockerHeight(map, key, receiver, receiver.place + reach * key.scale.w * glm::vec2(key.scale) * at);
    if (height == 0.0f || reach * glm::length(at) * key.scale.w > height * key.scale.w + receiver.bias)
      continue;
    const float relative = height / reach;
    found += 1.0f;
    powers += glm::vec3(relative, relative * relative, relative * relative * relative);
  }
  if (found == 0.0f) return {0.0f, 0.0f};
  const glm::vec3 moments = powers / found;
  const float variance = moments.y - moments.x * moments.x;
  if (variance < kOneHeight * kOneHeight * moments.x * moments.x)
    return {reach * moments.x, reach * moments.x};
  const float deviation = std::sqrt(variance);
  const float third = moments.z - 3.0f * moments.x * moments.y + 2.0f * moments.x * moments.x * moments.x;
  const float half_skew = 0.5f * third / (variance * deviation),
              root = std::sqrt(1.0f + half_skew * half_skew);
  const float low = std::clamp(moments.x + deviation * (half_skew - root), 0.02f * moments.x, 1.0f);
  const float high = std::clamp(moments.x + deviation * (half_skew + root), low, 1.0f);
  return {reach * low, reach * high};
}

template <typename Map>
int rayFromBelow(const Map& map, const KeyRecord& key, const KeyReceiver& receiver, float height,
                 glm::vec2 per_metre) {
  int fate = kRayFree;
  for (int i = 0; i < kKeyBetween; ++i) {
    const float below =
        height * (kLowestBetween + (kHighestBetween - kLowestBetween) * static_cast<float>(i) /
                                       static_cast<float>(kKeyBetween - 1));
    const float found = blockerHeight(map, key, receiver, receiver.place + below * per_metre);
    if (found <= below) continue;
    if (found < kKeySolid * below) return kRayBlocked;
    fate = kRayUnsure;
  }
  return fate;
}

template <typename Map>
int rayFate(const Map& map, const KeyRecord& key, const KeyReceiver& receiver, float height, glm::vec2 at) {
  const glm::vec2 per_metre = key.scale.w * glm::vec2(key.scale) * at;
  for (int i = 0; i < kKeySteps; ++i) {
    const float found = blockerHeight(map, key, receiver, receiver.place + height * per_metre);
    if (found == 0.0f) return rayFromBelow(map, key, receiver, height, per_metre);
    if (std::abs(found - height) < kOneHeight * height) return kRayBlocked;
    height = found;
  }
  return kRayBlocked;
}

template <typename Map>
float doubtOfBias(const Map& map, const KeyRecord& key, const KeyReceiver& receiver, glm::vec3 normal) {
  const glm::vec2 faced =
      glm::vec2(glm::dot(normal, glm::vec3(key.right)), glm::dot(normal, glm::vec3(key.up))) /
      glm::vec2(key.scale);
  KeyReceiver strict = receiver;
  strict.bias *= kDoubtfulBias;
  const glm::vec2 sure = texelShares(map, key, strict, receiver.place + kTexelsAside * faced);
  if (sure.y == 0.0f) return 0.0f;
  const float visible = texelShares(map, key, receiver, receiver.place).x;
  return visible > sure.x ? 1.0f - sure.x / visible : 0.0f;
}

template <typename Map>
glm::vec2 visibleBeyondBias(const Map& map, const KeyRecord& key, const KeyReceiver& receiver,
                            glm::vec3 normal, glm::vec3 shading_normal) {
  const glm::vec3 towards(key.towards);
  const glm::vec2 scale(key.scale);
  float reach = receiver.depth;
  const int rays = static_cast<int>(key.rays);
  KeyLayers layers{0.0f, 0.0f};
  bool open = false;
  for (int i = 0; i < kKeyNarrowing; ++i) {
    const glm::vec2 bounds = blockerBounds(map, key, receiver.place, reach * key.scale.w * scale + 1.0f);
    const float lean = glm::dot(glm::abs(receiver.slope), reach * key.scale.w * scale + 1.0f);
    if (bounds.x >= receiver.depth - receiver.bias) {
      open = true;
      break;
    }
    if (bounds.y < receiver.depth - lean - receiver.bias) return glm::vec2(0.0f);
    const float lower = receiver.depth - bounds.x;
    if (lower > 0.9f * reach) break;
    reach = lower;
  }
  if (open && receiver.above) return {1.0f, 0.0f};
  const glm::vec3 right = glm::normalize(glm::vec3(key.right)), up = glm::normalize(glm::vec3(key.up));
  if (!open) {
    const float widest = reach * key.scale.w * std::max(key.scale.x, key.scale.y);
    if (widest < kSharpTexels && receiver.above)
      return {texelShares(map, key, receiver, receiver.place).x, 0.0f};
    layers = keyLayers(map, key, receiver, reach, std::max(rays, kLeastSearch));
    if (layers.low == 0.0f && receiver.above) return {1.0f, 0.0f};
    if (layers.high * key.scale.w * std::max(key.scale.x, key.scale.y) < kSharpTexels && receiver.above)
      return {texelShares(map, key, receiver, receiver.place).x, 0.0f};
  }
  float visible = 0.0f, unsure = 0.0f, all = 0.0f;
  for (int i = 0; i < rays; ++i) {
    const glm::vec2 at = keyPoint(i, rays);
    const glm::vec3 ray = towards + key.scale.w * (at.x * right + at.y * up);
    const float weight = std::max(glm::dot(shading_normal, ray), 0.0f);
    all += weight;
    if (weight <= 0.0f || glm::dot(normal, ray) <= 0.0f) continue;
    int fate = kRayFree;
    if (layers.low > 0.0f) fate = rayFate(map, key, receiver, layers.low, at);
    if (fate != kRayBlocked && layers.high > layers.low)
      fate = std::min(fate, rayFate(map, key, receiver, layers.high, at));
    visible += fate == kRayFree ? weight : 0.0f;
    unsure += fate == kRayUnsure ? weight : 0.0f;
  }
  return all > 0.0f ? glm::vec2(visible, unsure) / all : glm::vec2(0.0f);
}

template <typename Map>
glm::vec2 keyVisible(const Map& map, const KeyRecord& key, glm::vec3 position, glm::vec3 normal,
                     glm::vec3 shading_normal) {
  if (glm::dot(normal, glm::vec3(key.towards)) <= -key.radiance.w) return glm::vec2(0.0f);
  const KeyReceiver receiver = keyReceiver(key, position, normal);
  const glm::vec2 visible = visibleBeyondBias(map, key, receiver, normal, shading_normal);
  const float doubtful = visible.x > 0.0f ? visible.x * doubtOfBias(map, key, receiver, normal) : 0.0f;
  return {visible.x - doubtful, visible.y + doubtful};
}

inline float keyShare(const KeyRecord& key, glm::vec3 shading_normal) {
  return sphereShare(glm::dot(shading_normal, glm::vec3(key.towards)), 1.0f / key.radiance.w);
}

}  // namespace lambent::frame::ref
