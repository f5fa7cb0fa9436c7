// This is the CPU twin of diffuse_eval.glsl and its entry shaders, with the same names, tables and order of
// terms, so that a test can compare the two and a debugger can step through what the GPU does. Memory is laid
// out as on the GPU: arena pages as 32-bit words. No GL.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/effects/diffuse/diffuse_shared.h"
#include "runtime/transfer/transfer_ref.hpp"

namespace lambent::effects::diffuse::ref {

using transfer::ref::diffuseLight;
using transfer::ref::kLuminance;
using transfer::ref::Memory;

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

inline transfer::ref::VertexRows rowsOf(const DrawRecord& draw) {
  return {draw.rows_word, draw.vertex_count, draw.row_entries};
}

inline float shadedShare(const glm::vec4& shaded) {
  return shaded.w > 0.0f ? 1.0f : 0.0f;
}

inline constexpr float kAllStraight = 1e4f;

inline glm::vec4 vertexRadiance(const Memory& memory, const DrawRecord& draw, uint vertex, glm::vec3 normal,
                                int order) {
  glm::vec4 sum(0.0f);
  float resident = 0.0f, total = 0.0f;
  if (draw.rows_word != kNoRows) {
    const uint end = memory.rowWordAt(draw.rows_word + vertex + 1);
    for (uint i = memory.rowWordAt(draw.rows_word + vertex); i < end; ++i) {
      const transfer::ref::RowEntry entry = rowEntryAt(memory, rowsOf(draw), i);
      const glm::vec4 shaded = memory.sampleAt(draw.first_output + entry.sample_index - draw.first_sample);
      sum += entry.weight * shadedShare(shaded) * glm::vec4(glm::vec3(shaded), shaded.w - 1.0f);
      resident += entry.weight * shadedShare(shaded);
      total += entry.weight;
    }
  }
  const auto unshadowed = [&] {
    return glm::vec4(unshadowedRadiance(memory, normal, draw.light, order), kAllStraight);
  };
  if (total == 0.0f) return unshadowed();
  if (resident < total) sum += (total - resident) * unshadowed();
  return sum / total;
}

inline glm::vec4 texelRadiance(const Memory& memory, const DrawRecord& draw, uint texel) {
  if (draw.texels_word == kNoRows) return glm::vec4(0.0f);
  const glm::vec4 shaded =
      memory.sampleAt(draw.first_output + memory.rowWordAt(draw.texels_word + texel) - draw.first_sample);
  return glm::vec4(shadedShare(shaded) * glm::vec3(shaded), shadedShare(shaded));
}

using MappedLight = std::array<glm::vec3, transfer::kMappedOutputs>;

inline MappedLight vertexLight(const Memory& memory, const DrawRecord& draw, uint vertex) {
  MappedLight light{};
  float resident = 0.0f, total = 0.0f;
  if (draw.rows_word != kNoRows) {
    const uint end = memory.rowWordAt(draw.rows_word + vertex + 1);
    for (uint i = memory.rowWordAt(draw.rows_word + vertex); i < end; ++i) {
      const transfer::ref::RowEntry entry = rowEntryAt(memory, rowsOf(draw), i);
      const uint first =
          draw.first_output + transfer::kMappedOutputs * (entry.sample_index - draw.first_sample);
      const float shaded = shadedShare(memory.sampleAt(first));
      for (uint j = 0; j < transfer::kMappedOutputs; ++j)
        light[j] += entry.weight * shaded * glm::vec3(memory.sampleAt(first + j));
      resident += entry.weight * shaded;
      total += entry.weight;
    }
  }
  const float unshadowed = total == 0.0f ? 1.0f : std::max(total - resident, 0.0f);
  for (uint j = 0; j < transfer::kMappedOutputs; ++j)
    light[j] = (light[j] + unshadowed * memory.lightAt(draw.light + j)) / (total == 0.0f ? 1.0f : total);
  return light;
}

// Stage c shades a vertex of draws without normal maps; vertexLight() serves draws with normal maps.
inline glm::vec4 shadeVertex(const Memory& memory, const DrawRecord& draw, uint vertex) {
  const uint at = draw.normals_word + 3 * vertex;
  const auto component = [&](uint i) { return std::bit_cast<float>(memory.geometry[at + i]); };
  const float* m = draw.group_from_mesh_normal;
  const glm::mat3 group_from_mesh(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
  const glm::vec3 normal =
      glm::normalize(group_from_mesh * glm::vec3(component(0), component(1), component(2)));
  return vertexRadiance(memory, draw, vertex, normal, static_cast<int>(draw.order));
}

// From here on are the functions of stage d, which shades the triangles of capture proxies.
inline glm::vec4 mappedRadiance(const Memory& memory, uint first, glm::vec3 normal) {
  std::array<glm::vec3, transfer::kMappedOutputs> light, straight;
  for (uint j = 0; j < transfer::kMappedOutputs; ++j) {
    const glm::vec4 value = memory.sampleAt(first + j);
    light[j] = glm::vec3(value);
    straight[j] = glm::vec3(value.w - 1.0f);
  }
  return glm::vec4(diffuseLight(light, normal), diffuseLight(straight, normal).r);
}

inline float keyVisibility(const Memory& memory, uint first, glm::vec3 direction) {
  constexpr std::array<float, transfer::kMappedOutputs> kBack = {1.0f, 1.5f, 1.5f, 1.5f, 4.0f,
                                                                 4.0f, 4.0f, 4.0f, 4.0f};
  std::array<glm::vec3, transfer::kMappedOutputs> visibility;
  for (uint j = 0; j < transfer::kMappedOutputs; ++j)
    visibility[j] = glm::vec3(kBack[j] * memory.sampleAt(first + j).w);
  return std::clamp(diffuseLight(visibility, direction).r, 0.0f, 1.0f);
}

inline glm::vec3 straightTint(const Memory& memory, const ProxyGroupRecord& group, glm::vec3 key,
                              float key_luminance) {
  glm::vec3 lamps(0.0f);
  for (uint k = 0; k < group.lamp_count; ++k) lamps += memory.lightAt(group.lamps + 2 * group.lamp_count + k);
  const float lamps_luminance = glm::dot(lamps, kLuminance);
  glm::vec3 sum(0.0f);
  float count = 0.0f;
  if (key_luminance > 0.0f) {
    sum += key / key_luminance;
    count += 1.0f;
  }
  if (lamps_luminance > 0.0f) {
    sum += lamps / lamps_luminance;
    count += 1.0f;
  }
  return sum / std::max(count, 1.0f);
}

inline glm::vec3 proxyRadiance(const Memory& memory, const ProxyGroupRecord& group,
                               const ProxyTriangleRecord& triangle,
                               std::span<const ProxyEntryRecord> entries) {
  const glm::vec3 normal(triangle.normal[0], triangle.normal[1], triangle.normal[2]);
  const uint key = group.light + transfer::kKeyBlock;
  const int order = static_cast<int>(group.order);
  const auto keyAt = [&](uint i) { return glm::dot(memory.lightAt(key + i), kLuminance); };
  const float key_luminance = keyAt(0);
  const glm::vec3 tint = straightTint(memory, group, memory.lightAt(key), key_luminance);
  const glm::vec3 towards_key(keyAt(3), keyAt(1), keyAt(2));
  glm::vec3 sum(0.0f), waiting(0.0f);
  for (const ProxyEntryRecord& entry : entries.subspan(triangle.first_entry, triangle.entry_count)) {
    const glm::vec3 reflectance(entry.reflectance[0], entry.reflectance[1], entry.reflectance[2]);
    const glm::vec4 shaded = memory.sampleAt(entry.sample_index);
    if (entry.outputs > transfer::kMappedOutputs) {
      sum += reflectance * glm::vec3(mappedRadiance(memory, entry.sample_index, normal));
      if (key_luminance > 0.0f)
        sum += reflectance * keyVisibility(memory, entry.sample_index, glm::normalize(towards_key)) *
               glm::max(unshadowedRadiance(memory, normal, key, order), glm::vec3(0.0f));
    } else if (shaded.w == 0.0f) {
      waiting += reflectance;
    } else {
      const glm::vec4 received = entry.outputs == 1 ? glm::vec4(glm::vec3(shaded), shaded.w - 1.0f)
                                                    : mappedRadiance(memory, entry.sample_index, normal);
      sum += reflectance * (glm::vec3(received) + std::max(received.w, 0.0f) * tint);
    }
  }
  if (waiting != glm::vec3(0.0f)) {
    glm::vec3 open = unshadowedRadiance(memory, normal, group.light, order);
    if (key_luminance > 0.0f) open += unshadowedRadiance(memory, normal, key, order);
    sum += waiting * open;
  }
  sum = glm::max(sum, glm::vec3(0.0f));
  if (triangle.lamp != kNoLamp)
    sum += glm::vec3(triangle.emission[0], triangle.emission[1], triangle.emission[2]) *
           memory.lightAt(group.lamps + triangle.lamp);
  return sum;
}

}  // namespace lambent::effects::diffuse::ref
