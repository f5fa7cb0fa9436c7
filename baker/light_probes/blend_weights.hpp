// Blends the light of several light probes at a point. The weights are smooth in space, sparse, and sum to 1.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/transfer/weights.hpp"

namespace lambent::baker {

struct BlendWeights {
  std::array<std::uint32_t, transfer::kLightsPerSample> light{};
  std::array<double, transfer::kLightsPerSample> weight{};  // falling; unused ones are 0
};

// Returns the weights, none negative, that minimize
//   |sum_k w_k x_k - p|² + lambda sum_k w_k (|x_k - p|² + e_k),
// where x_k are the light probes and p is the place. What varies linearly in space is blended exactly where
// light probes surround p, and the second term prefers near ones. Lifted to the paraboloid over the x_k, the
// weights are barycentric coordinates in the (regular) Delaunay tetrahedralization at a point near p: at most
// four are nonzero, and they have no jumps. e_k in [0, eps_m2) is a hash of x_k, and decides if more than
// four would do.
BlendWeights blendWeights(glm::vec3 place, std::span<const glm::vec3> lights, double eps_m2);

// These weights are in steps of 1/255, sum to 255 exactly (largest remainder), and descend. Weights that
// round to 0 name light 0. `light` keeps the numbers of BlendWeights.
struct QuantizedWeights {
  std::array<std::uint32_t, transfer::kLightsPerSample> light{};
  std::array<std::uint8_t, transfer::kLightsPerSample> weight{};
};
QuantizedWeights quantized(const BlendWeights& weights);

// Returns those of `lights` that can have a weight at some place inside the box.
std::vector<std::uint32_t> lightsNear(glm::vec3 box_min, glm::vec3 box_max,
                                      std::span<const glm::vec3> lights);

}  // namespace lambent::baker
