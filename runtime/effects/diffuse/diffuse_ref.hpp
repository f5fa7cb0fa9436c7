// The CPU twin of diffuse_eval.glsl and its entry shaders: same names, same tables, same order of terms, so
// that a test can hold one against the other and a debugger can step through what the GPU does. Memory is
// what the GPU sees: arena pages as 32-bit words. No GL.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/effects/diffuse/diffuse_shared.h"

namespace lambent::effects::diffuse::ref {

struct Memory {
  std::span<const glm::vec4> lights;
  std::span<const uint> transfer;      // page
  std::span<const glm::vec4> samples;  // page
  std::span<const uint> rows;          // page
  std::span<const uint> geometry;      // page

  glm::vec3 lightAt(uint index) const { return glm::vec3(lights[index]); }
  float basisAt(uint word) const { return std::bit_cast<float>(transfer[word]); }
  uint codeWordAt(uint word) const { return transfer[word]; }
  glm::vec4 sampleAt(uint index) const { return samples[index]; }
  uint rowWordAt(uint word) const { return rows[word]; }
};

inline float clampedCosineOverPi(int l) {
  constexpr std::array<float, 8> kWeights = {1.0f,          2.0f / 3.0f, 0.25f,        0.0f,
                                             -1.0f / 24.0f, 0.0f,        1.0f / 64.0f, 0.0f};
  return kWeights[static_cast<std::size_t>(l)];
}

inline glm::vec3 unshadowedRadiance(const Memory& memory, glm::vec3 normal, uint light, int order) {
  const auto ratio = [](int a, int b) { return std::sqrt(static_cast<float>(a) / static_cast<float>(b)); };
  glm::vec3 sum(0.0f);
  float c = 1.0f, s = 0.0f;
  float sectoral = 0.28209479177387814f;
  for (int m = 0; m < order; ++m) {
    if (m > 0) {
      const float next_c = normal.x * c - normal.y * s;
      s = normal.x * s + normal.y * c;
      c = next_c;
      sectoral *= m == 1 ? std::sqrt(3.0f) : ratio(2 * m + 1, 2 * m);
    }
    float p = sectoral, before = 0.0f;
    for (int l = m; l < order; ++l) {
      if (l > m) {
        const float z_factor = ratio(4 * l * l - 1, l * l - m * m);
        const float back =
            l == m + 1 ? 0.0f : z_factor * ratio((l - 1) * (l - 1) - m * m, 4 * (l - 1) * (l - 1) - 1);
        const float next = z_factor * normal.z * p - back * before;
        before = p;
        p = next;
      }
      const float weight = clampedCosineOverPi(l);
      if (weight == 0.0f) continue;
      const uint centre = light + static_cast<uint>(l * (l + 1)), offset = static_cast<uint>(m);
      const glm::vec3 ring = m == 0
                                 ? memory.lightAt(centre)
                                 : c * memory.lightAt(centre + offset) + s * memory.lightAt(centre - offset);
      sum += weight * p * ring;
    }
  }
  return sum;
}

inline glm::vec3 projectOnLight(const Memory& memory, const VectorRecord& vector, uint light, uint bands) {
  glm::vec3 sum(0.0f);
  for (uint i = 0; i < vector.columns; ++i) {
    glm::vec3 basis(memory.basisAt(vector.basis_word + i));
    if (vector.channels == 3) {
      basis.y = memory.basisAt(vector.basis_word + vector.columns + i);
      basis.z = memory.basisAt(vector.basis_word + 2 * vector.columns + i);
    }
    sum += basis * memory.lightAt(i < bands ? light + i : light + kLightStride + i - bands);
  }
  return sum;
}

inline uint codeOf(const Memory& memory, uint codes, uint sample_index) {
  const uint word = codes & ~kCodes16Bit;
  if ((codes & kCodes16Bit) != 0) {
    const uint pair = memory.codeWordAt(word + (sample_index >> 1));
    return (pair >> (16 * (sample_index & 1))) & 0xffff;
  }
  const uint four = memory.codeWordAt(word + (sample_index >> 2));
  return (four >> (8 * (sample_index & 3))) & 0xff;
}

// Stage a: products[cell.first_product ...].
inline void projectCell(const Memory& memory, const CellRecord& cell, std::span<const VectorRecord> vectors,
                        std::span<Product> products) {
  std::array<glm::vec3, kWorkGroupSize> means{};
  for (uint j = 0; j < cell.vector_count; ++j) {
    const VectorRecord& vector = vectors[cell.first_vector + j];
    const glm::vec3 value = projectOnLight(memory, vector, cell.light, vector.order * vector.order);
    means[j % kWorkGroupSize] += vector.offset * value;
    const glm::vec3 scaled = vector.scale * value;
    if (vector.slot > 0)
      products[cell.first_product + vector.slot] = {scaled.r, scaled.g, scaled.b, vector.codes};
  }
  glm::vec3 total(0.0f);
  for (const glm::vec3& mean : means) total += mean;
  products[cell.first_product] = {total.r, total.g, total.b, 0};
}

// Stage b.
inline glm::vec4 shadeSample(const Memory& memory, const CellRecord& cell, std::span<const Product> products,
                             uint sample_index) {
  const Product& mean = products[cell.first_product];
  glm::vec3 radiance(mean.r, mean.g, mean.b);
  for (uint j = 1; j <= cell.plane_count; ++j) {
    const Product& plane = products[cell.first_product + j];
    radiance +=
        static_cast<float>(codeOf(memory, plane.codes, sample_index)) * glm::vec3(plane.r, plane.g, plane.b);
  }
  return {radiance, 1.0f};
}

inline glm::vec3 vertexRadiance(const Memory& memory, const DrawRecord& draw, uint vertex, glm::vec3 normal,
                                int order) {
  glm::vec3 sum(0.0f);
  float resident = 0.0f, total = 0.0f;
  if (draw.rows_word != kNoRows) {
    const uint begin = memory.rowWordAt(draw.rows_word + vertex),
               end = memory.rowWordAt(draw.rows_word + vertex + 1);
    const uint samples_word = draw.rows_word + draw.vertex_count + 1;
    const uint weights_word = samples_word + draw.row_entries;
    for (uint entry = begin; entry < end; ++entry) {
      const uint pair = memory.rowWordAt(weights_word + (entry >> 1));
      const float weight = static_cast<float>((pair >> (16 * (entry & 1))) & 0xffff) / 65535.0f;
      const glm::vec4 shaded = memory.sampleAt(draw.first_sample + memory.rowWordAt(samples_word + entry));
      sum += weight * shaded.w * glm::vec3(shaded);
      resident += weight * shaded.w;
      total += weight;
    }
  }
  if (total == 0.0f) return unshadowedRadiance(memory, normal, draw.light, order);
  if (resident < total) sum += (total - resident) * unshadowedRadiance(memory, normal, draw.light, order);
  return sum / total;
}

// Stage c.
inline glm::vec3 shadeVertex(const Memory& memory, const DrawRecord& draw, uint vertex) {
  const uint at = draw.normals_word + 3 * vertex;
  const auto component = [&](uint i) { return std::bit_cast<float>(memory.geometry[at + i]); };
  const float* m = draw.group_from_mesh_normal;
  const glm::mat3 group_from_mesh(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
  const glm::vec3 normal =
      glm::normalize(group_from_mesh * glm::vec3(component(0), component(1), component(2)));
  return vertexRadiance(memory, draw, vertex, normal, static_cast<int>(draw.order));
}

}  // namespace lambent::effects::diffuse::ref
