// The shaders that look up shadows of local lights and key lights, as C++, and shadow maps of key lights for
// them: depths from a function of each texel's ray, and the pyramid over them by brute force.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/shadows/key_shared.h"
#include "runtime/shadows/local_shared.h"
#include "tests/support/glsl/glsl.hpp"

namespace lambent::frame {

// The tile is at the texture's first texel.
struct MadeMap {
  int size = 0;  // texels along an edge, a power of two, at least kBlockerTexels
  std::vector<float> depths;
  std::vector<std::vector<glm::vec2>> pyramid;  // by level

  MadeMap() = default;
  MadeMap(int edge, const std::function<float(glm::ivec2)>& depth) : size(edge) {
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) depths.push_back(depth({x, y}));
    for (int texels = static_cast<int>(kBlockerTexels); texels <= size; texels *= 2) {
      std::vector<glm::vec2>& level = pyramid.emplace_back();
      for (int y = 0; y < size; y += texels)
        for (int x = 0; x < size; x += texels) {
          glm::vec2 bounds(1.0f, 0.0f);
          for (int j = y; j < y + texels; ++j)
            for (int i = x; i < x + texels; ++i) {
              bounds.x = std::min(bounds.x, keyDepth({i, j}));
              bounds.y = std::max(bounds.y, keyDepth({i, j}));
            }
          level.push_back(bounds);
        }
    }
  }

  float keyDepth(glm::ivec2 texel) const {
    return depths[static_cast<std::size_t>(texel.y * size + texel.x)];
  }
  glm::vec2 keyBlockers(glm::ivec2 texel, int level) const {
    const int edge = size / (static_cast<int>(kBlockerTexels) << level);
    return pyramid[static_cast<std::size_t>(level)][static_cast<std::size_t>(texel.y * edge + texel.x)];
  }
};

// Makes a light in the direction `towards`. Its map covers `half` metres to each side of the origin, and as
// much above and below it, but at least 4.
inline KeyRecord madeKey(glm::vec3 towards, float radius_rad, float half, int size, float turn = 0.0f,
                         uint rays = 32) {
  const glm::vec3 beside = std::abs(towards.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 first = glm::normalize(glm::cross(beside, towards)), second = glm::cross(towards, first);
  const float texels = static_cast<float>(size) / (2.0f * half), last = static_cast<float>(size - 1);
  const float middle = 0.5f * static_cast<float>(size), top = 1.001f * std::max(half, 4.0f);
  return {.right = glm::vec4(texels * (std::cos(turn) * first + std::sin(turn) * second), middle),
          .up = glm::vec4(texels * (std::cos(turn) * second - std::sin(turn) * first), middle),
          .towards = glm::vec4(towards, top),
          .radiance = glm::vec4(glm::vec3(1.0f), std::sin(radius_rad)),
          .tile = glm::vec4(0, 0, last, last),
          .scale = glm::vec4(texels, texels, 2.0f * top, std::tan(radius_rad)),
          .rays = rays,
          .pad0 = 0,
          .pad1 = 0,
          .pad2 = 0};
}

// A KeyRay starts far away on the light's side and runs along -towards.
struct KeyRay {
  glm::dvec3 from, direction;
};

// Makes the map of a world whose function returns how far a ray goes until it hits something (negative:
// nothing).
template <typename Distance>
MadeMap madeMap(const KeyRecord& key, int size, const Distance& distance) {
  const glm::dvec3 towards{glm::vec3(key.towards)};
  const double scale = double{key.scale.x};
  const glm::dvec3 right = glm::dvec3(glm::vec3(key.right)) / (scale * scale),
                   up = glm::dvec3(glm::vec3(key.up)) / (scale * scale);
  return MadeMap(size, [&](glm::ivec2 texel) {
    const glm::dvec2 place = glm::dvec2(texel) + 0.5 - glm::dvec2(double{key.right.w}, double{key.up.w});
    const KeyRay ray{place.x * right + place.y * up + double{key.towards.w} * towards, -towards};
    const double far = distance(ray) / double{key.scale.z};
    return far < 0.0 || far > 1.0 ? 1.0f : static_cast<float>(far);
  });
}

}  // namespace lambent::frame

namespace lambent::frame::glsl {

using namespace lambent::glsl;

struct LocalShader {
  std::function<float(int face, ivec2 texel)> distance_at;  // reads the light's cube
  float localDistance(int, int face, ivec2 texel) { return distance_at(face, texel); }
#include "as_cpp/local_shadow.glsl"
};

struct KeyShader {
  const MadeMap* map = nullptr;
  // Places that are no numbers give any texel on the GPU, too.
  float keyDepth(ivec2 texel) { return map->keyDepth(clamp(texel, 0, map->size - 1)); }
  vec2 keyBlockers(ivec2 texel, int level) {
    return map->keyBlockers(clamp(texel, 0, (map->size / int(kBlockerTexels) >> level) - 1), level);
  }
#include "as_cpp/key_light.glsl"
};

}  // namespace lambent::frame::glsl
