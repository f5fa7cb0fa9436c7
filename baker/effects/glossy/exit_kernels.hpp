// How glossy surfaces reflect, as far as transport asks: L_out(q -> v) = Σ_k c_k(v) l'_k (surface_brdfs.hpp).
// Handed in as functions, so that the passes know no materials.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include <glm/vec3.hpp>

namespace lambent::baker {

struct ExitKernels {
  bool grey = true;  // red, green and blue are the same
  // Towards the unit direction `to` (group frame, away from the surface) of the point with barycentric
  // weights u, v of corners 1 and 2: out[channel * order_out² + k], three channels. From any thread.
  std::function<void(std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out)> at;
};

}  // namespace lambent::baker
