// The CPU twin of diffuse_eval.glsl and its entry shaders: same names, same tables, same order of terms, so
// that a test can hold one against the other and a debugger can step through what the GPU does. Memory is
// what the GPU sees: arena pages as 32-bit words. No GL.
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

#include "runtime/effects/diffuse/diffuse_light_ref.hpp"
#include "runtime/effects/diffuse/diffuse_shared.h"

namespace lambent::effects::diffuse::ref {

struct Memory {
  std::span<const glm::vec4> lights;
  std::span<const uint> transfer;      // page
  std::span<const glm::vec4> samples;  // page
  std::span<const uint> rows;          // page
  std::span<const uint> geometry;      // page

  glm::vec3 lightAt(uint index) const { return glm::vec3(lights[index]); }
  float floatAt(uint word) const { return std::bit_cast<float>(transfer[word]); }
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

inline constexpr glm::vec3 kLuminance{0.2126f, 0.7152f, 0.0722f};

inline glm::vec3 timesLight(const Memory& memory, uint at, uint channels, uint stride, uint columns,
                            uint light, float rest, float key) {
  glm::vec3 sum(0.0f);
  for (uint i = 0; i < columns; ++i) {
    glm::vec3 arriving = rest * memory.lightAt(light + i);
    if (key != 0.0f) arriving += key * memory.lightAt(light + kKeyBlock + i);
    glm::vec3 value(memory.floatAt(at + i));
    if (channels > 1) {
      value.g = memory.floatAt(at + stride + i);
      value.b = memory.floatAt(at + 2 * stride + i);
    }
    sum += value * arriving;
  }
  return sum;
}

inline glm::vec4 projectOnLight(const Memory& memory, const TransferRecord& transfer, uint vector,
                                uint output_index, uint light) {
  const uint columns = transfer.columns, stride = transfer.outputs * columns;
  const uint first = transfer.vectors_word + vector * transfer.vector_size + output_index * columns;
  const auto bounced = static_cast<float>(transfer.bounced);
  const glm::vec3 sum = timesLight(memory, first + transfer.first_value, transfer.channels, stride, columns,
                                   light, 1.0f, bounced);
  if (transfer.straight_channels == 0) return glm::vec4(sum, 0.0f);
  const glm::vec3 straight =
      timesLight(memory, first, transfer.straight_channels, stride, columns, light, 0.0f, 1.0f);
  return glm::vec4(sum - bounced * straight, glm::dot(straight, kLuminance));
}

inline uint codeOf(const Memory& memory, uint codes, uint position) {
  const uint word = codes & ~kCodes16Bit;
  if ((codes & kCodes16Bit) != 0) {
    const uint pair = memory.codeWordAt(word + (position >> 1));
    return (pair >> (16 * (position & 1))) & 0xffff;
  }
  const uint four = memory.codeWordAt(word + (position >> 2));
  return (four >> (8 * (position & 3))) & 0xff;
}

// The vectors of a cluster: its mean, then its axes as far as they are resident.
struct ResidentCluster {
  uint first, axes;
};

inline ResidentCluster clusterAt(const Memory& memory, const TransferRecord& transfer, uint cluster) {
  const uint word = transfer.clusters_word + 2 * cluster;
  return {memory.codeWordAt(word), std::min(memory.codeWordAt(word + 1), transfer.plane_count)};
}

// Stage a, one output of one cluster under one light: its products, the mean's with all offsets in it.
// projected(vector, output, light): the vector times the light.
template <typename Projected>
void projectCluster(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
                    uint light_index, uint cluster, uint output_index, const Projected& projected,
                    std::span<glm::vec4> products) {
  const uint light = places[transfer.first_light + light_index];
  const ResidentCluster at = clusterAt(memory, transfer, cluster);
  const auto product = [&](uint vector) -> glm::vec4& {
    return products[transfer.first_product + transfer.light_products * light_index +
                    transfer.outputs * vector + output_index];
  };
  std::array<glm::vec4, kLanesPerUnit> means{};
  for (uint v = 0; v <= at.axes; ++v) {
    const uint vector = at.first + v;
    const glm::vec4 value = projected(vector, output_index, light);
    means[v % kLanesPerUnit] += memory.floatAt(transfer.weights_word + 2 * vector) * value;
    if (v > 0) product(vector) = memory.floatAt(transfer.weights_word + 2 * vector + 1) * value;
  }
  glm::vec4 total(0.0f);
  for (const glm::vec4& mean : means) total += mean;
  product(at.first) = total;
}

template <typename Projected>
void projectClusters(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
                     const Projected& projected, std::span<glm::vec4> products) {
  for (uint light = 0; light < transfer.light_count; ++light)
    for (uint cluster = 0; cluster < transfer.clusters; ++cluster)
      for (uint j = 0; j < transfer.outputs; ++j)
        projectCluster(memory, transfer, places, light, cluster, j, projected, products);
}

inline void projectTransfer(const Memory& memory, const TransferRecord& transfer,
                            std::span<const uint> places, std::span<glm::vec4> products) {
  const auto projected = [&](uint vector, uint output_index, uint light) {
    return projectOnLight(memory, transfer, vector, output_index, light);
  };
  projectClusters(memory, transfer, places, projected, products);
}

// Whose code stands at a position: the sample of the cell, and its cluster.
struct CodedSample {
  uint sample_index;
  ResidentCluster cluster;
};

inline CodedSample codedSampleAt(const Memory& memory, const TransferRecord& transfer, uint position) {
  const uint place = memory.codeWordAt(transfer.positions_word + position);
  return {place & 0xffff, clusterAt(memory, transfer, place >> 16)};
}

// How much of light k falls on a sample of the cell.
struct LightShare {
  uint light;
  float weight;
};

inline LightShare lightShareOf(const Memory& memory, const TransferRecord& transfer, uint sample_index,
                               uint k) {
  if (transfer.light_count == 1) return {0, k == 0 ? 1.0f : 0.0f};
  const uint word = transfer.light_weights_word + 2 * sample_index;
  return {memory.codeWordAt(word) >> (8 * k) & 0xff,
          static_cast<float>(memory.codeWordAt(word + 1) >> (8 * k) & 0xff) / 255.0f};
}

// Stage b: one position of the cell, into its sample.
inline void shadePosition(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
                          std::span<const glm::vec4> products, uint position, std::span<glm::vec4> samples) {
  const CodedSample at = codedSampleAt(memory, transfer, position);
  for (uint j = 0; j < transfer.outputs; ++j) {
    glm::vec4 light(0.0f);
    for (uint k = 0; k < kLightsPerSample; ++k) {
      const LightShare share = lightShareOf(memory, transfer, at.sample_index, k);
      uint product = transfer.first_product + transfer.light_products * share.light +
                     transfer.outputs * at.cluster.first + j;
      light += share.weight * products[product];
      for (uint axis = 0; axis < at.cluster.axes; ++axis) {
        product += transfer.outputs;
        light += static_cast<float>(codeOf(memory, places[transfer.first_plane + axis], position)) *
                 share.weight * products[product];
      }
    }
    glm::vec4& out = samples[transfer.first_output + transfer.outputs * at.sample_index + j];
    if (transfer.accumulate != 0)
      light += out;
    else
      light.w = 1.0f + (j == 0 ? std::max(light.w, 0.0f) : light.w);
    out = light;
  }
}

struct RowEntry {
  float weight;
  uint sample_index;
};

inline RowEntry rowEntryAt(const Memory& memory, const DrawRecord& draw, uint entry) {
  const uint samples_word = draw.rows_word + draw.vertex_count + 1;
  const uint pair = memory.rowWordAt(samples_word + draw.row_entries + (entry >> 1));
  return {static_cast<float>((pair >> (16 * (entry & 1))) & 0xffff) / 65535.0f,
          memory.rowWordAt(samples_word + entry)};
}

inline float shadedShare(const glm::vec4& shaded) {
  return shaded.w > 0.0f ? 1.0f : 0.0f;
}

inline glm::vec3 vertexRadiance(const Memory& memory, const DrawRecord& draw, uint vertex, glm::vec3 normal,
                                int order) {
  glm::vec3 sum(0.0f);
  float resident = 0.0f, total = 0.0f;
  if (draw.rows_word != kNoRows) {
    const uint end = memory.rowWordAt(draw.rows_word + vertex + 1);
    for (uint i = memory.rowWordAt(draw.rows_word + vertex); i < end; ++i) {
      const RowEntry entry = rowEntryAt(memory, draw, i);
      const glm::vec4 shaded = memory.sampleAt(draw.first_sample + entry.sample_index);
      sum += entry.weight * shadedShare(shaded) * glm::vec3(shaded);
      resident += entry.weight * shadedShare(shaded);
      total += entry.weight;
    }
  }
  if (total == 0.0f) return unshadowedRadiance(memory, normal, draw.light, order);
  if (resident < total) sum += (total - resident) * unshadowedRadiance(memory, normal, draw.light, order);
  return sum / total;
}

using MappedLight = std::array<glm::vec3, kMappedOutputs>;

inline MappedLight vertexLight(const Memory& memory, const DrawRecord& draw, uint vertex) {
  MappedLight light{};
  float resident = 0.0f, total = 0.0f;
  if (draw.rows_word != kNoRows) {
    const uint end = memory.rowWordAt(draw.rows_word + vertex + 1);
    for (uint i = memory.rowWordAt(draw.rows_word + vertex); i < end; ++i) {
      const RowEntry entry = rowEntryAt(memory, draw, i);
      const uint first = draw.first_sample + kMappedOutputs * entry.sample_index;
      const float shaded = shadedShare(memory.sampleAt(first));
      for (uint j = 0; j < kMappedOutputs; ++j)
        light[j] += entry.weight * shaded * glm::vec3(memory.sampleAt(first + j));
      resident += entry.weight * shaded;
      total += entry.weight;
    }
  }
  const float unshadowed = total == 0.0f ? 1.0f : std::max(total - resident, 0.0f);
  for (uint j = 0; j < kMappedOutputs; ++j)
    light[j] = (light[j] + unshadowed * memory.lightAt(draw.light + j)) / (total == 0.0f ? 1.0f : total);
  return light;
}

// Stage c, draws without normal maps; vertexLight is those with.
inline glm::vec3 shadeVertex(const Memory& memory, const DrawRecord& draw, uint vertex) {
  const uint at = draw.normals_word + 3 * vertex;
  const auto component = [&](uint i) { return std::bit_cast<float>(memory.geometry[at + i]); };
  const float* m = draw.group_from_mesh_normal;
  const glm::mat3 group_from_mesh(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
  const glm::vec3 normal =
      glm::normalize(group_from_mesh * glm::vec3(component(0), component(1), component(2)));
  return vertexRadiance(memory, draw, vertex, normal, static_cast<int>(draw.order));
}

// Stage d.
inline glm::vec4 mappedRadiance(const Memory& memory, uint first, glm::vec3 normal) {
  std::array<glm::vec3, kMappedOutputs> light, straight;
  for (uint j = 0; j < kMappedOutputs; ++j) {
    const glm::vec4 value = memory.sampleAt(first + j);
    light[j] = glm::vec3(value);
    straight[j] = glm::vec3(value.w - 1.0f);
  }
  return glm::vec4(diffuseLight(light, normal), diffuseLight(straight, normal).r);
}

inline float keyVisibility(const Memory& memory, uint first, glm::vec3 direction) {
  constexpr std::array<float, kMappedOutputs> kBack = {1.0f, 1.5f, 1.5f, 1.5f, 4.0f, 4.0f, 4.0f, 4.0f, 4.0f};
  std::array<glm::vec3, kMappedOutputs> visibility;
  for (uint j = 0; j < kMappedOutputs; ++j)
    visibility[j] = glm::vec3(kBack[j] * memory.sampleAt(first + j).w);
  return std::clamp(diffuseLight(visibility, direction).r, 0.0f, 1.0f);
}

inline glm::vec3 proxyRadiance(const Memory& memory, const ProxyGroupRecord& group,
                               const ProxyTriangleRecord& triangle,
                               std::span<const ProxyEntryRecord> entries) {
  const glm::vec3 normal(triangle.normal[0], triangle.normal[1], triangle.normal[2]);
  const uint key = group.light + kKeyBlock;
  const int order = static_cast<int>(group.order);
  const auto keyAt = [&](uint i) { return glm::dot(memory.lightAt(key + i), kLuminance); };
  const float key_luminance = keyAt(0);
  const glm::vec3 tint = key_luminance > 0.0f ? memory.lightAt(key) / key_luminance : glm::vec3(0.0f);
  const glm::vec3 towards_key(keyAt(3), keyAt(1), keyAt(2));
  glm::vec3 sum(0.0f), waiting(0.0f);
  for (const ProxyEntryRecord& entry : entries.subspan(triangle.first_entry, triangle.entry_count)) {
    const glm::vec3 reflectance(entry.reflectance[0], entry.reflectance[1], entry.reflectance[2]);
    const glm::vec4 shaded = memory.sampleAt(entry.sample_index);
    if (entry.outputs > kMappedOutputs) {
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
