// How the light of several light probes is blended at a place: smooth, sparse and summing to 1.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/bundle/light_weights.hpp"

namespace lambent::baker {

struct BlendWeights {
  std::array<std::uint32_t, bundle::kLightsPerSample> light{};
  std::array<double, bundle::kLightsPerSample> weight{};  // falling; unused ones are 0
};

// The weights, none negative, that minimize
//   |sum_k w_k x_k - p|² + lambda sum_k w_k (|x_k - p|² + e_k),
// x_k the light probes, p the place: what varies evenly in space is blended exactly where light probes
// stand around p, and the second term takes the near ones. It is lifted to the paraboloid over the x_k, so
// that the weights are barycentric coordinates in the (regular) Delaunay tetrahedralization at a point near
// to p: no more than four, without a jump anywhere. e_k in [0, eps_m2), drawn by x_k, decides where more than
// four would do.
BlendWeights blendWeights(glm::vec3 place, std::span<const glm::vec3> lights, double eps_m2);

// In steps of 1/255 that sum to 255 exactly (largest remainder), falling; those that come to 0 name light 0.
// `light` is left as numbers of BlendWeights.
struct QuantizedWeights {
  std::array<std::uint32_t, bundle::kLightsPerSample> light{};
  std::array<std::uint8_t, bundle::kLightsPerSample> weight{};
};
QuantizedWeights quantized(const BlendWeights& weights);

// Those of `lights` that can have a weight at a place inside the box.
std::vector<std::uint32_t> lightsNear(glm::vec3 box_min, glm::vec3 box_max,
                                      std::span<const glm::vec3> lights);

}  // namespace lambent::baker
