// This is the CPU twin of volume_march.glsl and volume_scatter.comp, with the same names and order of terms.
// Texture lookups of the GPU are interpolated here from the same texels. No GL.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/effects/volume/volume_shared.h"
#include "runtime/sh/basis.hpp"

namespace lambent::effects::volume::ref {

inline constexpr float kInfinity = 1e30f;
inline constexpr float kDeep = 9.2103404f;

// Holds a texture of floats or vec4s; x varies fastest.
template <typename T>
struct Texels {
  glm::uvec3 size{1};
  std::vector<T> values = std::vector<T>(1, T(0.0f));

  T& at(const glm::uvec3& texel) {
    return values[texel.x + std::size_t{size.x} * (texel.y + std::size_t{size.y} * texel.z)];
  }
  const T& at(const glm::uvec3& texel) const { return const_cast<Texels*>(this)->at(texel); }
  // Interpolates linearly between texel centres and clamps beyond the outermost. `place` is 0..1.
  T sample(const glm::vec3& place) const {
    const glm::vec3 last(size - 1u);
    const glm::vec3 at_texel = glm::clamp(place * glm::vec3(size) - 0.5f, glm::vec3(0.0f), last);
    const glm::vec3 low = glm::min(glm::floor(at_texel), glm::max(last - 1.0f, glm::vec3(0.0f)));
    const glm::vec3 part = at_texel - low;
    T sum(0.0f);
    for (unsigned corner = 0; corner < 8; ++corner) {
      const glm::vec3 side(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::vec3 share = glm::mix(1.0f - part, part, side);
      sum += share.x * share.y * share.z * at(glm::uvec3(glm::min(low + side, last)));
    }
    return sum;
  }
};

// Holds a volume as the march reads it.
struct Medium {
  MarchRecord record{};
  Texels<float> density;
  Texels<glm::vec4> light;
  std::vector<float> block_maxima;
};

// Writes what the scatter kernel writes for the samples of a cell. If record.open is set, it writes that many
// coefficients of the light itself.
inline void scatter(const ScatterRecord& record, std::span<const uint> voxels,
                    std::span<const glm::vec4> samples, std::span<const glm::vec4> lights,
                    Texels<glm::vec4>& out) {
  for (uint at = 0; at < record.sample_count; ++at) {
    const uint voxel = voxels[record.first_voxel + at];
    const glm::uvec3 place(voxel % record.size[0], voxel / record.size[0] % record.size[1],
                           voxel / (record.size[0] * record.size[1]));
    for (uint j = 0; j < record.outputs; ++j) {
      const float factor = std::pow(record.g, static_cast<float>(sh::bandOf(static_cast<int>(j))));
      glm::vec3 light(0.0f);
      if (record.open == 0)
        light = samples[record.first_output + record.outputs * at + j];
      else if (j < record.open)
        light = (record.outputs == 1 ? 0.282094792f : 1.0f) * glm::vec3(lights[record.light + j]);
      out.at(place + glm::uvec3(record.size[0] * (j / record.slabs_z), 0,
                                record.size[2] * (j % record.slabs_z))) = glm::vec4(factor * light, 1.0f);
    }
  }
}

inline float lostOf(float x) {
  return x < 0.02f ? x * (1.0f - x * (0.5f - x / 6.0f)) : 1.0f - std::exp(-x);
}

inline float meanPlace(float x) {
  return x < 0.3f ? 0.5f - x / 12.0f + x * x * x / 720.0f
                  : 1.0f / x - 1.0f / (std::exp(std::min(x, 80.0f)) - 1.0f);
}

struct VolumeRay {
  glm::vec3 origin{0.0f}, direction{0.0f}, towards{0.0f};
  float metres = 1.0f, enter = 0.0f, leave = 0.0f, voxel = 1.0f;
  glm::ivec3 block{0}, last_block{0};
  glm::vec3 exits{0.0f}, strides{0.0f};
};

inline glm::vec3 rotated(const glm::vec4 (&rows)[3], const glm::vec3& v) {
  return {glm::dot(glm::vec3(rows[0]), v), glm::dot(glm::vec3(rows[1]), v), glm::dot(glm::vec3(rows[2]), v)};
}

inline VolumeRay enterVolume(const MarchRecord& record, const glm::vec3& origin_vs, const glm::vec3& dir_vs,
                             float begin) {
  VolumeRay ray;
  ray.origin = rotated(record.box_from_view, origin_vs) +
               glm::vec3(record.box_from_view[0].w, record.box_from_view[1].w, record.box_from_view[2].w);
  ray.direction = rotated(record.box_from_view, dir_vs);
  const glm::vec3 in_group = rotated(record.group_from_view, dir_vs);
  ray.metres = glm::length(in_group);
  ray.towards = in_group / ray.metres;
  const glm::vec3 size(record.size);
  const float speed = glm::length(size * ray.direction);
  ray.voxel = 1.0f / speed;
  ray.enter = begin;
  ray.leave = kInfinity;
  const glm::vec3 blocks = size / static_cast<float>(kBlock);
  ray.last_block = glm::ivec3((record.size - 1u) / kBlock);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(size[axis] * ray.direction[axis]) < 1e-6f * speed) ray.direction[axis] = 0.0f;
    const float o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0.0f) {
      if (std::abs(o - 0.5f) > 0.5f) ray.leave = -kInfinity;
    } else {
      const float first = -o / d, second = (1.0f - o) / d;
      ray.enter = std::max(ray.enter, std::min(first, second));
      ray.leave = std::min(ray.leave, std::max(first, second));
    }
  }
  const glm::vec3 place = (ray.origin + ray.enter * ray.direction) * blocks;
  for (int axis = 0; axis < 3; ++axis) {
    const auto last = static_cast<float>(ray.last_block[axis]);
    ray.block[axis] = static_cast<int>(std::clamp(std::floor(place[axis]), 0.0f, last));
    const float o = ray.origin[axis], d = ray.direction[axis];
    const auto border = static_cast<float>(ray.block[axis] + (d > 0.0f ? 1 : 0));
    ray.exits[axis] = d == 0.0f ? kInfinity : (border / blocks[axis] - o) / d;
    ray.strides[axis] = d == 0.0f ? 0.0f : 1.0f / (blocks[axis] * std::abs(d));
  }
  return ray;
}

inline bool followBlocks(VolumeRay& ray, float t) {
  while (std::min(ray.exits.x, std::min(ray.exits.y, ray.exits.z)) <= t) {
    const int axis = ray.exits.x <= std::min(ray.exits.y, ray.exits.z) ? 0
                     : ray.exits.y <= ray.exits.z                      ? 1
                                                                       : 2;
    ray.block[axis] += ray.direction[axis] > 0.0f ? 1 : -1;
    ray.exits[axis] += ray.strides[axis];
    if (ray.block[axis] < 0 || ray.block[axis] > ray.last_block[axis]) return false;
  }
  return true;
}

inline bool blockFilled(const VolumeRay& ray, std::span<const float> block_maxima) {
  const glm::uvec3 block(ray.block), count(ray.last_block + 1);
  return block_maxima[block.x + std::size_t{count.x} * (block.y + std::size_t{count.y} * block.z)] > 0.0f;
}

inline float extinctionAt(const Medium& medium, const VolumeRay& ray, float t) {
  return medium.record.density_scale * ray.metres * medium.density.sample(ray.origin + t * ray.direction);
}

inline glm::vec3 scatteredAt(const Medium& medium, const VolumeRay& ray, float t) {
  const MarchRecord& record = medium.record;
  const glm::vec3 transfer_size(record.transfer_size), light_size(record.light_size);
  const glm::vec3 place =
      glm::clamp((ray.origin + t * ray.direction) * transfer_size, glm::vec3(0.5f), transfer_size - 0.5f);
  glm::vec4 light = medium.light.sample(place / light_size);
  if (record.outputs > 1) {
    std::array<float, 36> y{};
    int bands = 1;
    while (bands * bands < static_cast<int>(record.outputs)) ++bands;
    sh::evaluate(bands, ray.towards, std::span(y).first(record.outputs));
    glm::vec3 sum = y[0] * glm::vec3(light);
    for (uint j = 1; j < record.outputs; ++j) {
      const glm::vec3 slab(static_cast<float>(j / record.slabs_z), 0.0f,
                           static_cast<float>(j % record.slabs_z));
      sum += y[j] * glm::vec3(medium.light.sample((place + slab * transfer_size) / light_size));
    }
    light = glm::vec4(sum, light.a);
  }
  return light.a > 0.0f ? glm::vec3(light) / light.a : glm::vec3(0.0f);
}

// Returns scattered radiance (RGB) and optical depth (alpha) up to each of the stops.
inline std::vector<glm::vec4> marchVolumes(std::span<const Medium> media, std::vector<VolumeRay> rays,
                                           std::span<const float> stops, float step_voxels, float jitter) {
  glm::vec4 sum(0.0f);
  float t = kInfinity, last = -kInfinity;
  for (const VolumeRay& ray : rays) {
    if (ray.enter >= ray.leave) continue;
    t = std::min(t, ray.enter);
    last = std::max(last, ray.leave);
  }
  std::vector<glm::vec4> gathered;
  for (;;) {
    while (gathered.size() < stops.size() && (t >= std::min(stops[gathered.size()], last) || sum.a > kDeep))
      gathered.push_back(sum);
    if (gathered.size() == stops.size()) return gathered;
    float end = std::min(stops[gathered.size()], last), width = kInfinity;
    std::vector<bool> filled(rays.size(), false);
    bool any = false;
    for (std::size_t v = 0; v < rays.size(); ++v) {
      VolumeRay& ray = rays[v];
      if (t >= ray.leave) continue;
      if (t < ray.enter) {
        end = std::min(end, ray.enter);
        continue;
      }
      if (!followBlocks(ray, t)) {
        ray.leave = t;
        continue;
      }
      end = std::min(std::min(end, ray.leave), std::min(ray.exits.x, std::min(ray.exits.y, ray.exits.z)));
      if (!blockFilled(ray, media[v].block_maxima)) continue;
      filled[v] = any = true;
      width = std::min(width, ray.voxel);
    }
    if (any) {
      float steps = std::clamp(std::ceil((end - t) / (step_voxels * width) - 1e-3f), 1.0f,
                               static_cast<float>(kMostSteps));
      width = (end - t) / steps;
      if (jitter < 1.0f) steps += 1.0f;
      for (float k = 0.0f; k < steps && sum.a <= kDeep; k += 1.0f) {
        const float a = std::max(t, t + (k - 1.0f + jitter) * width),
                    b = std::min(end, t + (k + jitter) * width);
        std::vector<float> extinction(rays.size(), 0.0f);
        float all = 0.0f;
        for (std::size_t v = 0; v < rays.size(); ++v) {
          if (filled[v]) extinction[v] = extinctionAt(media[v], rays[v], 0.5f * (a + b));
          all += extinction[v];
        }
        const float depth = all * (b - a);
        if (!(depth > 0.0f)) continue;
        const float place = a + meanPlace(depth) * (b - a);
        glm::vec3 light(0.0f);
        for (std::size_t v = 0; v < rays.size(); ++v) {
          if (extinction[v] == 0.0f) continue;
          light += extinction[v] / all * media[v].record.albedo * scatteredAt(media[v], rays[v], place);
        }
        sum += glm::vec4(std::exp(-sum.a) * lostOf(depth) * light, 0.0f);
        sum.a += depth;
      }
    }
    t = end;
  }
}

// Describes a ray from `begin` to `end` metres, in view space.
struct RaySegment {
  glm::vec3 origin_vs, dir_vs;
  float begin = 0.0f, end = kInfinity;
};

inline glm::vec4 march(std::span<const Medium> media, const RaySegment& ray, float step_voxels = 0.5f,
                       float jitter = 1.0f) {
  std::vector<VolumeRay> rays;
  for (const Medium& medium : media)
    rays.push_back(enterVolume(medium.record, ray.origin_vs, ray.dir_vs, ray.begin));
  return marchVolumes(media, std::move(rays), std::span(&ray.end, 1), step_voxels, jitter).front();
}

}  // namespace lambent::effects::volume::ref
