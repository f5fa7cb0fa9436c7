// This is the CPU twin of the shader modules of this room and of the kernels that evaluate coded transfer,
// with the same names, tables and order of terms, so that a test can compare the two and a debugger can step
// through what the GPU does. Memory is laid out as on the GPU: arena pages as 32-bit words. No GL.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/sh/basis.hpp"
#include "runtime/transfer/seen_sky_shared.h"
#include "runtime/transfer/transfer_shared.h"

namespace lambent::transfer::ref {

struct Memory {
  std::span<const glm::vec4> lights;
  std::span<const uint> transfer;      // arena page
  std::span<const glm::vec4> samples;  // arena page
  std::span<const uint> rows;          // arena page
  std::span<const uint> geometry;      // arena page

  glm::vec3 lightAt(uint index) const { return glm::vec3(lights[index]); }
  float floatAt(uint word) const { return std::bit_cast<float>(transfer[word]); }
  uint codeWordAt(uint word) const { return transfer[word]; }
  glm::vec4 sampleAt(uint index) const { return samples[index]; }
  uint rowWordAt(uint word) const { return rows[word]; }
};

inline constexpr glm::vec3 kLuminance{0.2126f, 0.7152f, 0.0722f};

// Describes a transfer vector in memory: its first word, and the number of words from one channel to the next
// (`stride`).
struct TransferVector {
  uint at, channels, stride, columns;
};

// Names the light that is multiplied: a share of what starts at index `rest`, plus a share of what is shaded
// per pixel and starts at index `key`.
struct ArrivingLight {
  uint rest, key;
  float rest_share, key_share;
};

inline glm::vec3 timesLight(const Memory& memory, const TransferVector& vector, const ArrivingLight& light) {
  const auto [at, channels, stride, columns] = vector;
  glm::vec3 sum(0.0f);
  for (uint i = 0; i < columns; ++i) {
    glm::vec3 arriving = light.rest_share * memory.lightAt(light.rest + i);
    if (light.key_share != 0.0f) arriving += light.key_share * memory.lightAt(light.key + i);
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
  const uint key = light + transfer.apart;
  const glm::vec3 sum = timesLight(memory, {first + transfer.first_value, transfer.channels, stride, columns},
                                   {light, key, 1.0f, bounced});
  if (transfer.straight_channels == 0) return glm::vec4(sum, 0.0f);
  const glm::vec3 straight =
      timesLight(memory, {first, transfer.straight_channels, stride, columns}, {light, key, 0.0f, 1.0f});
  // In samples of glossy surfaces, w is how visible light is.
  const float sent_on = transfer.outputs > kMappedOutputs ? 0.0f : glm::dot(straight, kLuminance);
  return glm::vec4(sum - bounced * straight, sent_on);
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

// Names the vectors of a cluster: its mean, then those of its axes that are resident.
struct ResidentCluster {
  uint first, axes;
};

inline ResidentCluster clusterAt(const Memory& memory, const TransferRecord& transfer, uint cluster) {
  const uint word = transfer.clusters_word + 2 * cluster;
  return {memory.codeWordAt(word), std::min(memory.codeWordAt(word + 1), transfer.plane_count)};
}

// Names what one unit of stage a computes, by indices within the transfer.
struct ProjectUnit {
  uint light, cluster, output;
};

// Stage a for one output of one cluster under one light: writes its products, that of the mean with all
// offsets included. projected(vector, output, light) returns the vector times the light.
template <typename Projected>
void projectCluster(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
                    const ProjectUnit& unit, const Projected& projected, std::span<glm::vec4> products) {
  const uint light = places[transfer.first_light + unit.light];
  const ResidentCluster at = clusterAt(memory, transfer, unit.cluster);
  const auto product = [&](uint vector) -> glm::vec4& {
    return products[transfer.first_product + transfer.light_products * unit.light +
                    transfer.outputs * vector + unit.output];
  };
  std::array<glm::vec4, kLanesPerUnit> means{};
  for (uint v = 0; v <= at.axes; ++v) {
    const uint vector = at.first + v;
    const glm::vec4 value = projected(vector, unit.output, light);
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
        projectCluster(memory, transfer, places, {light, cluster, j}, projected, products);
}

// Stage a for vectors and matrices.
inline void projectVectors(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
                           std::span<glm::vec4> products) {
  const auto projected = [&](uint vector, uint output_index, uint light) {
    return projectOnLight(memory, transfer, vector, output_index, light);
  };
  projectClusters(memory, transfer, places, projected, products);
}

// Names the sample of the cell whose code stands at a position, and its cluster.
struct CodedSample {
  uint sample_index;
  ResidentCluster cluster;
};

inline CodedSample codedSampleAt(const Memory& memory, const TransferRecord& transfer, uint position) {
  const uint place = memory.codeWordAt(transfer.positions_word + position);
  return {place & 0xffff, clusterAt(memory, transfer, place >> 16)};
}

// Holds the share of a light probe in the light of a sample.
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

// Stage b for vectors: shades the sample at one position of the cell.
inline void shadeVector(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
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

inline glm::vec4 projectVisibility(const Memory& memory, std::span<const uint> gaunt,
                                   const TransferRecord& transfer, uint vector, uint output_index,
                                   uint light) {
  const uint at = transfer.vectors_word + vector * transfer.vector_size;
  glm::vec3 sum(0.0f);
  const uint first_term = transfer.outputs + 1, end = gaunt[output_index + 1];
  for (uint t = gaunt[output_index]; t < end; ++t) {
    const uint jk = gaunt[first_term + kGauntTermWords * t];
    const float value = std::bit_cast<float>(gaunt[first_term + kGauntTermWords * t + 1]);
    sum += value * memory.floatAt(at + (jk >> 16)) * memory.lightAt(light + (jk & 0xffff));
  }
  return {sum, memory.floatAt(at + output_index)};
}

// Stage a for visibility.
inline void projectVisibilities(const Memory& memory, std::span<const uint> gaunt,
                                const TransferRecord& transfer, std::span<const uint> places,
                                std::span<glm::vec4> products) {
  const auto projected = [&](uint vector, uint output_index, uint light) {
    return projectVisibility(memory, gaunt, transfer, vector, output_index, light);
  };
  projectClusters(memory, transfer, places, projected, products);
}

// Stage b for matrices: shades all outputs of the sample at one position of the cell.
inline void shadeMatrix(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
                        std::span<const glm::vec4> products, uint position, std::span<glm::vec4> samples) {
  const CodedSample at = codedSampleAt(memory, transfer, position);
  for (uint j = 0; j < transfer.outputs; ++j) {
    glm::vec4 light(0.0f);
    for (uint k = 0; k < kLightsPerSample; ++k) {
      const LightShare share = lightShareOf(memory, transfer, at.sample_index, k);
      if (share.weight == 0.0f) break;
      uint product = transfer.first_product + transfer.light_products * share.light +
                     transfer.outputs * at.cluster.first + j;
      light += share.weight * products[product];
      for (uint axis = 0; axis < at.cluster.axes; ++axis) {
        product += transfer.outputs;
        const uint code = codeOf(memory, places[transfer.first_plane + axis], position);
        light += static_cast<float>(code) * share.weight * products[product];
      }
    }
    glm::vec4& out = samples[transfer.first_output + transfer.outputs * at.sample_index + j];
    out = transfer.accumulate != 0 ? light + out : light;
  }
}

// These match vertex_rows.glsl.
struct VertexRows {
  uint word, vertex_count, entries;
};

struct RowEntry {
  float weight;
  uint sample_index;
};

inline RowEntry rowEntryAt(const Memory& memory, const VertexRows& rows, uint entry) {
  const uint samples_word = rows.word + rows.vertex_count + 1;
  const uint pair = memory.rowWordAt(samples_word + rows.entries + (entry >> 1));
  return {static_cast<float>((pair >> (16 * (entry & 1))) & 0xffff) / 65535.0f,
          memory.rowWordAt(samples_word + entry)};
}

// This is the CPU twin of diffuse_light.glsl, with the same names and order of terms. Vectors are in the
// group's frame; light is given by real orthonormal coefficients of bands 0..2 (docs/conventions.md). No GL.
inline glm::vec3 diffuseLight(const std::array<glm::vec3, 9>& light, glm::vec3 n) {
  return 0.28209479f * light[0] + 0.32573501f * (n.y * light[1] + n.z * light[2] + n.x * light[3]) +
         0.27313711f * (n.x * n.y * light[4] + n.y * n.z * light[5] + n.x * n.z * light[7]) +
         0.07884789f * (3.0f * n.z * n.z - 1.0f) * light[6] +
         0.13656855f * (n.x * n.x - n.y * n.y) * light[8];
}

// This is the CPU twin of seen_sky.glsl, with the same names. No GL.
inline std::array<float, kSeenBands> seenBands(std::span<const float, kSeenCoefficients> c,
                                               const glm::vec3& d) {
  std::array<float, kSeenCoefficients> y;
  sh::evaluate(static_cast<int>(kSeenBands), d, y);
  std::array<float, kSeenBands> bands{};
  for (std::size_t l = 0; l < bands.size(); ++l)
    for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) bands[l] += c[k] * y[k];
  return bands;
}

inline float seenShare(std::span<const float, kSeenCoefficients> c, std::span<const float> weights,
                       std::span<const glm::vec3> axes, const glm::mat3& frame) {
  float sum = 0.0f;
  for (std::size_t i = 0; i < kSeenBands; ++i) {
    const std::array<float, kSeenBands> bands = seenBands(c, frame * axes[i]);
    for (std::size_t l = i; l < kSeenBands; ++l) sum += weights[l * (l + 1) / 2 + i] * bands[l];
  }
  return std::clamp(sum, 0.0f, 1.0f);
}

inline float seenShareOfAll(std::span<const float, kSeenCoefficients> c) {
  return std::clamp(3.5449077f * c[0], 0.0f, 1.0f);
}

}  // namespace lambent::transfer::ref
