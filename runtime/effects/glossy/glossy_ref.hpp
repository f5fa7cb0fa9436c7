// This is the CPU twin of glossy_eval.glsl and its entry shaders, with the same names, tables and order of
// terms. Memory is laid out as on the GPU, as in diffuse_ref.hpp, whose decoding of codes it shares. No GL.
#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/effects/glossy/glossy_shared.h"
#include "runtime/transfer/transfer_ref.hpp"

namespace lambent::effects::glossy::ref {

using transfer::ref::Memory;

inline constexpr float kSqrtFourPi = 3.5449077018110318f;

// Returns one output of a sample in a cell without transfer, as glossy_eval.glsl does.
inline glm::vec4 openLight(const Memory& memory, const FillRecord& fill, uint output_index) {
  const glm::vec3 light =
      output_index < fill.coefficients ? memory.lightAt(fill.light + output_index) : glm::vec3(0.0f);
  return {light, output_index == 0 && fill.open != 0 ? kSqrtFourPi : 0.0f};
}

}  // namespace lambent::effects::glossy::ref
