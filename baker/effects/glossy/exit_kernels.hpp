// Describes to light transport how glossy surfaces reflect: L_out(q -> v) = Σ_k c_k(v) l'_k
// (surface_brdfs.hpp). Kernels are passed in as a function, so that the passes know no materials.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include <glm/vec3.hpp>

namespace lambent::baker {

struct ExitKernels {
  bool grey = true;  // red, green and blue are the same
  // Computes the kernel towards the unit direction `to` (group frame, away from the surface) of the point
  // with barycentric weights u, v of corners 1 and 2: out[channel * order_out² + k], three channels, of at
  // most as many bands as the surfaces have. May be called from any thread.
  std::function<void(std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out)> at;
};

}  // namespace lambent::baker
