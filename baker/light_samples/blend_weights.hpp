// How the light of several light samples is blended at a place: smooth, sparse and summing to 1.
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
  std::array<double, bundle::kLightsPerSample> weight{};  // of the nearest first; unused ones are 0
};

// Modified Shepard weights (Franke and Nielson 1980) of the four nearest light samples:
//   w_k ~ ((R - d_k)+ / (R d_k))^2, d_k the distance, R that of the fifth nearest,
// so that a light sample fades out before another takes its place, and there is no jump anywhere. Ours
// differs: d_k² + eps stands for d_k² (at a light sample the weight is not infinite), and with up to four
// light samples R is infinite.
BlendWeights blendWeights(glm::vec3 place, std::span<const glm::vec3> lights, double eps_m2);

// In steps of 1/255 that sum to 255 exactly (largest remainder), falling; those that come to 0 name light 0.
// `light` is left as numbers of BlendWeights.
struct QuantizedWeights {
  std::array<std::uint32_t, bundle::kLightsPerSample> light{};
  std::array<std::uint8_t, bundle::kLightsPerSample> weight{};
};
QuantizedWeights quantized(const BlendWeights& weights);

// Those of `lights` that can be among the five nearest of a place inside the box.
std::vector<std::uint32_t> lightsNear(glm::vec3 box_min, glm::vec3 box_max,
                                      std::span<const glm::vec3> lights);

}  // namespace lambent::baker
