// The CPU twin of glossy_eval.glsl and its entry shaders: same names, same tables, same order of terms.
// Memory is what the GPU sees, as in diffuse_ref.hpp, whose decoding of codes it shares. No GL.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/effects/diffuse/diffuse_ref.hpp"
#include "runtime/effects/glossy/glossy_shared.h"

namespace lambent::effects::glossy::ref {

using diffuse::TransferRecord;
using diffuse::ref::Memory;

inline constexpr float kSqrtFourPi = 3.5449077018110318f;

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

// Stage a, all outputs of all clusters under all lights. Transfers without visibility:
// diffuse::ref::projectTransfer.
inline void projectTransfer(const Memory& memory, std::span<const uint> gaunt, const TransferRecord& transfer,
                            std::span<const uint> places, std::span<glm::vec4> products) {
  for (uint light_index = 0; light_index < transfer.light_count; ++light_index)
    for (uint cluster = 0; cluster < transfer.clusters; ++cluster)
      for (uint j = 0; j < transfer.outputs; ++j) {
        const uint light = places[transfer.first_light + light_index];
        const uint first = memory.codeWordAt(transfer.clusters_word + 2 * cluster);
        const uint axes =
            std::min(memory.codeWordAt(transfer.clusters_word + 2 * cluster + 1), transfer.plane_count);
        const uint first_product = transfer.first_product + transfer.light_products * light_index;
        std::array<glm::vec4, diffuse::kLanesPerUnit> means{};
        for (uint v = 0; v <= axes; ++v) {
          const uint vector = first + v;
          const glm::vec4 value = projectVisibility(memory, gaunt, transfer, vector, j, light);
          means[v % diffuse::kLanesPerUnit] += memory.floatAt(transfer.weights_word + 2 * vector) * value;
          if (v > 0)
            products[first_product + transfer.outputs * vector + j] =
                memory.floatAt(transfer.weights_word + 2 * vector + 1) * value;
        }
        glm::vec4 total(0.0f);
        for (const glm::vec4& mean : means) total += mean;
        products[first_product + transfer.outputs * first + j] = total;
      }
}

// Stage b: one position of the cell, into all outputs of its sample.
inline void shadePosition(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
                          std::span<const glm::vec4> products, uint position, std::span<glm::vec4> samples) {
  const uint place = memory.codeWordAt(transfer.positions_word + position);
  const uint sample_index = place & 0xffff, cluster = place >> 16;
  const uint first = memory.codeWordAt(transfer.clusters_word + 2 * cluster);
  const uint axes =
      std::min(memory.codeWordAt(transfer.clusters_word + 2 * cluster + 1), transfer.plane_count);
  for (uint j = 0; j < transfer.outputs; ++j) {
    glm::vec4 light(0.0f);
    for (uint k = 0; k < diffuse::kLightsPerSample; ++k) {
      const diffuse::ref::LightShare share = diffuse::ref::lightShareOf(memory, transfer, sample_index, k);
      if (share.weight == 0.0f) break;
      uint product =
          transfer.first_product + transfer.light_products * share.light + transfer.outputs * first + j;
      light += share.weight * products[product];
      for (uint axis = 0; axis < axes; ++axis) {
        product += transfer.outputs;
        const uint code = diffuse::ref::codeOf(memory, places[transfer.first_plane + axis], position);
        light += static_cast<float>(code) * share.weight * products[product];
      }
    }
    glm::vec4& out = samples[transfer.first_output + transfer.outputs * sample_index + j];
    out = transfer.accumulate != 0 ? light + out : light;
  }
}

// Cells without transfer.
inline glm::vec4 openLight(const Memory& memory, const FillRecord& fill, uint output_index) {
  const glm::vec3 light =
      output_index < fill.coefficients ? memory.lightAt(fill.light + output_index) : glm::vec3(0.0f);
  return {light, output_index == 0 ? kSqrtFourPi : 0.0f};
}

}  // namespace lambent::effects::glossy::ref
