// This is the CPU twin of neighborhood_eval.glsl and neighborhood_write.comp, with the same names and order
// of terms. No GL.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/effects/neighborhood/neighborhood_shared.h"

namespace lambent::effects::neighborhood::ref {

// Holds the texture as the GPU does: x varies fastest, then y, then z.
struct Atlas {
  std::size_t width = 1, height = 1, depth = 1;
  std::vector<glm::vec4> texels;

  Atlas(std::size_t w, std::size_t h, std::size_t d) : width(w), height(h), depth(d), texels(w * h * d) {}
  glm::vec4& texel(std::size_t x, std::size_t y, std::size_t z) {
    return texels[(z * height + y) * width + x];
  }
  const glm::vec4& texel(std::size_t x, std::size_t y, std::size_t z) const {
    return texels[(z * height + y) * width + x];
  }

  // Interpolates linearly between texel centres at i + 0.5; beyond the outermost centre the value is
  // constant.
  glm::vec4 at(const glm::vec3& place) const {
    const glm::vec3 last(static_cast<float>(width - 1), static_cast<float>(height - 1),
                         static_cast<float>(depth - 1));
    const glm::vec3 from = glm::clamp(place - 0.5f, glm::vec3(0.0f), last);
    const glm::vec3 low = glm::floor(from), part = from - low;
    glm::vec4 sum(0.0f);
    for (unsigned corner = 0; corner < 8; ++corner) {
      float share = 1.0f;
      std::array<std::size_t, 3> index{};
      for (int axis = 0; axis < 3; ++axis) {
        const bool high = (corner >> axis & 1u) != 0;
        share *= high ? part[axis] : 1.0f - part[axis];
        index[static_cast<std::size_t>(axis)] =
            static_cast<std::size_t>(std::min(low[axis] + (high ? 1.0f : 0.0f), last[axis]));
      }
      sum += share * texel(index[0], index[1], index[2]);
    }
    return sum;
  }
};

// Writes the samples point by point and output by output, rounded to half floats.
inline void write(Atlas& atlas, const WriteRecord& cell, std::span<const glm::vec4> samples) {
  const auto half = [](float value) { return glm::unpackHalf1x16(glm::packHalf1x16(value)); };
  for (uint element = 0; element < cell.point_count * cell.grid.outputs; ++element) {
    const uint point = cell.first_point + element % cell.point_count, slab = element / cell.point_count;
    const glm::vec4 change =
        samples[cell.first_output + cell.grid.outputs * (point - cell.first_point) + slab];
    const uint x = point % cell.grid.size_x, row = point / cell.grid.size_x;
    const uint y = row % cell.grid.size_y, z = row / cell.grid.size_y;
    const glm::vec3 light = glm::clamp(glm::vec3(change) / cell.grid.scale, -6e4f, 6e4f);
    atlas.texel(x, cell.grid.first_y + cell.grid.size_y * (slab / cell.grid.slabs_per_column) + y,
                cell.grid.first_z + cell.grid.size_z * (slab % cell.grid.slabs_per_column) + z) = {
        half(light.r), half(light.g), half(light.b), half(change.a)};
  }
}

inline glm::vec3 lastOf(const GridPlace& grid) {
  return {static_cast<float>(grid.size_x - 1), static_cast<float>(grid.size_y - 1),
          static_cast<float>(grid.size_z - 1)};
}

inline float gridShare(const glm::vec3& place, const GridPlace& grid) {
  const glm::vec3 last = lastOf(grid);
  const glm::vec3 t =
      glm::clamp(glm::min(place, last - place) / glm::min(glm::vec3(1.0f), 0.5f * last), 0.0f, 1.0f);
  const glm::vec3 rise = t * t * (3.0f - 2.0f * t);
  return rise.x * rise.y * rise.z;
}

inline glm::vec4 gridOutput(const Atlas& atlas, const glm::vec3& place, const GridPlace& grid, uint slab) {
  const glm::vec3 first(0.0f, static_cast<float>(grid.first_y + grid.size_y * (slab / grid.slabs_per_column)),
                        static_cast<float>(grid.first_z + grid.size_z * (slab % grid.slabs_per_column)));
  return glm::vec4(glm::vec3(grid.scale), 1.0f) *
         atlas.at(first + glm::clamp(place, glm::vec3(0.0f), lastOf(grid)) + 0.5f);
}

inline glm::vec3 gridIrradiance(const Atlas& atlas, const glm::vec3& place, const GridPlace& grid,
                                const glm::vec3& n) {
  const auto output = [&](uint slab) { return glm::vec3(gridOutput(atlas, place, grid, slab)); };
  glm::vec3 sum = 0.28209479f * output(0);
  sum += 0.32573501f * (n.y * output(1) + n.z * output(2) + n.x * output(3));
  sum += 0.27313711f * (n.x * n.y * output(4) + n.y * n.z * output(5) + n.x * n.z * output(7));
  sum += 0.07884789f * (3.0f * n.z * n.z - 1.0f) * output(6);
  sum += 0.13656855f * (n.x * n.x - n.y * n.y) * output(8);
  return sum;
}

inline glm::vec3 withChange(const glm::vec3& light, const glm::vec3& change) {
  return glm::max(light + change, glm::min(light, glm::vec3(0.0f)));
}

}  // namespace lambent::effects::neighborhood::ref
