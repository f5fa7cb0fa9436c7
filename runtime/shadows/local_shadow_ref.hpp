// This is the CPU twin of local_shadow.glsl, with the same names and order of terms. A texel of the shadow
// cube is read through `Distance`: float(int face, glm::ivec2 texel), metres along the ray through its
// centre. Points and directions are relative to the light's centre, in world axes. No GL.
#pragma once

#include <glm/common.hpp>

#include "runtime/shadows/shadowed_light.hpp"

namespace lambent::frame::ref {

inline constexpr float kNothing = 1e30f;
inline constexpr float kBiasTexels = 1.5f;
inline constexpr float kSearchWidth = 2.0f, kFoundWidth = 3.0f;
inline constexpr float kOneLayer = 0.01f;
inline constexpr int kSteps = 4;
inline constexpr float kMet = 2.0f;
inline constexpr float kLeastSquared = 1e-12f;
inline constexpr float kGoldenAngle = 2.39996323f;

struct ShadowReceiver {
  glm::vec3 position;
  glm::vec3 normal;
  glm::vec3 horizon;
  float distance;
  float bias;
};

inline ShadowReceiver shadowReceiver(glm::vec3 position, glm::vec3 normal, glm::vec3 horizon, int size) {
  return {position, normal, horizon, glm::length(position), kBiasTexels * 2.0f / static_cast<float>(size)};
}

inline int shadowFace(glm::vec3 d) {
  const glm::vec3 a = glm::abs(d);
  if (a.x >= a.y && a.x >= a.z) return d.x < 0.0f ? 1 : 0;
  if (a.y >= a.z) return d.y < 0.0f ? 3 : 2;
  return d.z < 0.0f ? 5 : 4;
}
inline glm::vec3 faceForward(int face) {
  const float way = (face & 1) == 1 ? -1.0f : 1.0f;
  return face < 2 ? glm::vec3(way, 0, 0) : face < 4 ? glm::vec3(0, way, 0) : glm::vec3(0, 0, way);
}
inline glm::vec3 faceUp(int face) {
  return face == 2 || face == 3 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
}
inline glm::vec3 faceRight(int face) {
  return glm::cross(faceForward(face), faceUp(face));
}

inline glm::vec2 facePlace(int face, glm::vec3 d, int size) {
  const glm::vec2 at =
      glm::vec2(glm::dot(faceRight(face), d), glm::dot(faceUp(face), d)) / glm::dot(faceForward(face), d);
  return (0.5f * at + 0.5f) * static_cast<float>(size);
}
inline glm::vec3 texelDirection(int face, glm::vec2 place, int size) {
  const glm::vec2 at = 2.0f * place / static_cast<float>(size) - 1.0f;
  return localUnit(faceForward(face) + at.x * faceRight(face) + at.y * faceUp(face));
}

struct Blocker {
  glm::vec3 direction;
  float distance;
};
template <typename Distance>
Blocker blockerAt(const Distance& distance, glm::vec3 direction, int size) {
  const int face = shadowFace(direction);
  const glm::ivec2 texel = glm::clamp(glm::ivec2(glm::floor(facePlace(face, direction, size))), glm::ivec2(0),
                                      glm::ivec2(size - 1));
  return {texelDirection(face, glm::vec2(texel) + 0.5f, size), distance(face, texel)};
}

inline float planeDistance(const ShadowReceiver& receiver, glm::vec3 direction) {
  const float plane = glm::dot(receiver.normal, receiver.position),
              along = glm::dot(receiver.normal, direction);
  return plane * along > 0.0f ? plane / along : kNothing;
}

template <typename Distance>
float pointVisible(const Distance& distance, const ShadowReceiver& receiver, int size) {
  if (glm::dot(receiver.horizon, receiver.position) >= 0.0f) return 0.0f;
  const int face = shadowFace(receiver.position);
  const glm::vec2 place = facePlace(face, receiver.position, size) - 0.5f;
  const glm::vec2 corner = glm::floor(place), part = place - corner;
  float visible = 0.0f;
  for (int i = 0; i < 4; ++i) {
    const glm::vec2 side(static_cast<float>(i & 1), static_cast<float>(i >> 1));
    const glm::vec2 share = side * part + (1.0f - side) * (1.0f - part);
    const Blocker blocker = blockerAt(distance, texelDirection(face, corner + side + 0.5f, size), size);
    const float limit = std::min(receiver.distance, planeDistance(receiver, blocker.direction));
    if (blocker.distance >= limit * (1.0f - receiver.bias)) visible += share.x * share.y;
  }
  return visible;
}

struct LightDisc {
  glm::vec3 normal;
  float height;
  float radius;
  glm::vec3 s, t;
};
inline LightDisc lightDisc(const ShadowedLightRecord& light, const ShadowReceiver& receiver) {
  LightDisc disc;
  const bool sphere = light.kind == kLocalSphere;
  disc.normal = sphere ? localUnit(receiver.position) : light.direction;
  disc.height = glm::dot(disc.normal, receiver.position);
  const float sine = std::min(light.radius / receiver.distance, 0.99f);
  disc.radius = sphere ? light.radius / std::sqrt(1.0f - sine * sine) : light.radius;
  localBasis(disc.normal, disc.s, disc.t);
  return disc;
}

inline glm::vec2 discPoint(int i, int count, float turns) {
  const float angle = kGoldenAngle * static_cast<float>(i) + 2.0f * kLocalPi * turns;
  return std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count)) *
         glm::vec2(std::cos(angle), std::sin(angle));
}

inline float linePoint(int i) {
  std::uint32_t reversed = 0;
  for (int bit = 0; bit < 32; ++bit) reversed |= (static_cast<std::uint32_t>(i) >> bit & 1u) << (31 - bit);
  return static_cast<float>(reversed) * 2.3283064e-10f;
}

inline float blockerHeight(const ShadowReceiver& receiver, const LightDisc& disc, float radius,
                           const Blocker& blocker) {
  if (blocker.distance >= planeDistance(receiver, blocker.direction) * (1.0f - receiver.bias)) return -1.0f;
  const glm::vec3 place = blocker.distance * blocker.direction;
  const float height = glm::dot(disc.normal, place) / disc.height;
  if (height <= 0.0f || height >= 1.0f - receiver.bias) return -1.0f;
  const float scale = 1.0f / (1.0f - height);
  const glm::vec3 seen = receiver.position + scale * (place - receiver.position);
  const float doubt = receiver.bias * blocker.distance * scale;
  return glm::dot(seen, seen) <= (radius + doubt) * (radius + doubt) ? height : -1.0f;
}

// Tells how shadow cubes are looked up: the texels along an edge of a face, the points on a light with an
// extent, and the rotation of these points, in turns.
struct ShadowLookup {
  int size, count;
  float turns;
};

struct BlockerLayers {
  float low, high;
};
template <typename Distance>
BlockerLayers blockerLayers(const Distance& distance, const ShadowReceiver& receiver, const LightDisc& disc,
                            const ShadowLookup& lookup) {
  const auto [size, count, turns] = lookup;
  float found = 0.0f;
  glm::vec3 powers(0.0f);
  for (int i = 0; i < count; ++i) {
    const glm::vec2 at = kSearchWidth * disc.radius * discPoint(i, count, turns);
    const float down = i == 0 ? 0.0f : glm::fract(linePoint(i) + turns), up = 1.0f - down * std::sqrt(down);
    const glm::vec3 place = (1.0f - up) * (at.x * disc.s + at.y * disc.t) + up * receiver.position;
    const float height =
        blockerHeight(receiver, disc, kFoundWidth * disc.radius, blockerAt(distance, place, size));
    if (height < 0.0f) continue;
    found += 1.0f;
    powers += glm::vec3(height, height * height, height * height * height);
  }
  if (found == 0.0f) return {1.0f, 1.0f};
  const glm::vec3 moments = powers / found;
  const float variance = moments.y - moments.x * moments.x;
  if (variance < kOneLayer * kOneLayer) return {moments.x, moments.x};
  const float deviation = std::sqrt(variance);
  const float third = moments.z - 3.0f * moments.x * moments.y + 2.0f * moments.x * moments.x * moments.x;
  const float half_skew = 0.5f * third / (variance * deviation),
              root = std::sqrt(1.0f + half_skew * half_skew);
  return {std::clamp(moments.x + deviation * (half_skew - root), 0.0f, 1.0f),
          std::clamp(moments.x + deviation * (half_skew + root), 0.0f, 1.0f)};
}

template <typename Distance>
float heightOnRay(float up, const Distance& distance, const ShadowReceiver& receiver, const LightDisc& disc,
                  glm::vec2 unit_place, int size) {
  const float least = receiver.bias * 0.5f * receiver.distance * up / std::max(1.0f - up, 1e-3f);
  const glm::vec2 at = std::max(disc.radius, least) * unit_place;
  const glm::vec3 place = (1.0f - up) * (at.x * disc.s + at.y * disc.t) + up * receiver.position;
  return blockerHeight(receiver, disc, kFoundWidth * disc.radius, blockerAt(distance, place, size));
}

template <typename Distance>
bool blockedNear(float up, const Distance& distance, const ShadowReceiver& receiver, const LightDisc& disc,
                 glm::vec2 unit_place, int size) {
  float before = 0.0f, behind = 1.0f, apart = 1.0f;
  bool enclosed = false;
  for (int i = 0; i < kSteps; ++i) {
    const float height = heightOnRay(up, distance, receiver, disc, unit_place, size);
    const bool found = height >= 0.0f;
    if (!found && !enclosed) return false;
    if (found) {
      apart = std::abs(height - up);
      if (apart < kOneLayer) return true;
    }
    if (found && height < up) {
      behind = up;
      enclosed = true;
    } else {
      before = up;
    }
    up = height > before && height < behind ? height : 0.5f * (before + behind);
  }
  return enclosed && apart < kMet * (behind - before);
}

template <typename Distance>
float discVisible(const Distance& distance, const ShadowedLightRecord& light, const ShadowReceiver& receiver,
                  glm::vec3 shading_normal, const ShadowLookup& lookup) {
  const auto [size, count, turns] = lookup;
  const LightDisc disc = lightDisc(light, receiver);
  if (disc.height <= 0.0f) return 0.0f;
  const BlockerLayers layers = blockerLayers(distance, receiver, disc, lookup);
  const int layer_count = layers.low >= 1.0f ? 0 : layers.low < layers.high ? 2 : 1;
  const glm::vec2 slope(glm::dot(receiver.horizon, disc.s), glm::dot(receiver.horizon, disc.t));
  const bool above = -glm::dot(receiver.horizon, receiver.position) > disc.radius * glm::length(slope);
  const int points = layer_count == 0 && above ? 0 : count;
  float visible = 0.0f, all = 0.0f;
  for (int i = 0; i < points; ++i) {
    const glm::vec2 unit_place = discPoint(i, count, turns), at = disc.radius * unit_place;
    const glm::vec3 ray = at.x * disc.s + at.y * disc.t - receiver.position;
    const float squared = std::max(glm::dot(ray, ray), kLeastSquared),
                weight = std::max(glm::dot(shading_normal, ray), 0.0f) / (squared * squared);
    all += weight;
    if (weight <= 0.0f || glm::dot(receiver.horizon, ray) <= 0.0f) continue;
    bool blocked = false;
    for (int k = 0; k < layer_count && !blocked; ++k)
      blocked = blockedNear(k == 0 ? layers.low : layers.high, distance, receiver, disc, unit_place, size);
    if (!blocked) visible += weight;
  }
  return all > 0.0f ? visible / all : 1.0f;
}

// Describes a point of a surface; its normals are those of the vertices, of the triangle, and for shading.
struct ShadedPoint {
  glm::vec3 position, normal, horizon, shading_normal;
};

template <typename Distance>
glm::vec3 localRadiance(const Distance& distance, const ShadowedLightRecord& light, const ShadedPoint& point,
                        const ShadowLookup& lookup) {
  const auto& [position, normal, horizon, shading_normal] = point;
  const glm::vec3 to_light = light.position - position;
  const float share = localShare(light, shading_normal, to_light);
  if (share <= 0.0f) return glm::vec3(0.0f);
  const ShadowReceiver receiver = shadowReceiver(-to_light, normal, horizon, lookup.size);
  const bool flat_light = light.kind == kLocalPoint || light.kind == kLocalSpot;
  if (light.kind == kLocalSphere && receiver.distance <= light.radius) return share * light.power;
  const float visible = flat_light ? pointVisible(distance, receiver, lookup.size)
                                   : discVisible(distance, light, receiver, shading_normal, lookup);
  return visible * share * light.power;
}

}  // namespace lambent::frame::ref
