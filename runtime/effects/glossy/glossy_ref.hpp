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

// Stage a of visibility. Other transfers: diffuse::ref::projectTransfer.
inline void projectTransfer(const Memory& memory, std::span<const uint> gaunt, const TransferRecord& transfer,
                            std::span<const uint> places, std::span<glm::vec4> products) {
  const auto projected = [&](uint vector, uint output_index, uint light) {
    return projectVisibility(memory, gaunt, transfer, vector, output_index, light);
  };
  diffuse::ref::projectClusters(memory, transfer, places, projected, products);
}

// Stage b: one position of the cell, into all outputs of its sample.
inline void shadePosition(const Memory& memory, const TransferRecord& transfer, std::span<const uint> places,
                          std::span<const glm::vec4> products, uint position, std::span<glm::vec4> samples) {
  const diffuse::ref::CodedSample at = diffuse::ref::codedSampleAt(memory, transfer, position);
  for (uint j = 0; j < transfer.outputs; ++j) {
    glm::vec4 light(0.0f);
    for (uint k = 0; k < diffuse::kLightsPerSample; ++k) {
      const diffuse::ref::LightShare share = diffuse::ref::lightShareOf(memory, transfer, at.sample_index, k);
      if (share.weight == 0.0f) break;
      uint product = transfer.first_product + transfer.light_products * share.light +
                     transfer.outputs * at.cluster.first + j;
      light += share.weight * products[product];
      for (uint axis = 0; axis < at.cluster.axes; ++axis) {
        product += transfer.outputs;
        const uint code = diffuse::ref::codeOf(memory, places[transfer.first_plane + axis], position);
        light += static_cast<float>(code) * share.weight * products[product];
      }
    }
    glm::vec4& out = samples[transfer.first_output + transfer.outputs * at.sample_index + j];
    out = transfer.accumulate != 0 ? light + out : light;
  }
}

// Cells without transfer.
inline glm::vec4 openLight(const Memory& memory, const FillRecord& fill, uint output_index) {
  const glm::vec3 light =
      output_index < fill.coefficients ? memory.lightAt(fill.light + output_index) : glm::vec3(0.0f);
  return {light, output_index == 0 && fill.open != 0 ? kSqrtFourPi : 0.0f};
}

}  // namespace lambent::effects::glossy::ref
