// Computes the light that leaves glossy surfaces: L_out(q -> v) = Σ_k c_k(v) l'_k, with c the exit kernel of
// q (surface_brdfs.hpp) and l' the light that the matrices of its samples transfer there. Kernels are a
// function, so that the passes know no materials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/trace/hits.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

inline constexpr std::size_t kMostGlossyOutputs = sh::coefficientCount(sh::kMaxFactoredOrder);

struct ExitKernels {
  bool grey = true;  // red, green and blue are the same
  // Computes the kernel towards the unit direction `to` (group frame, away from the surface) of the point
  // with barycentric weights u, v of corners 1 and 2: out[channel * order_out² + k], three channels, of at
  // most as many bands as the surfaces have. May be called from any thread.
  std::function<void(std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out)> at;
};

// GlossyMatrices are matrices of all glossy samples: [sample][channel][output][column].
struct GlossyMatrices {
  std::size_t channels = 1, outputs = 25, columns = 25;
  std::vector<float> values;

  std::size_t matrixSize() const { return outputs * columns; }
  std::size_t sampleSize() const { return channels * matrixSize(); }
  std::span<float> at(std::size_t sample) {
    return std::span(values).subspan(sample * sampleSize(), sampleSize());
  }
  std::span<const float> at(std::size_t sample) const {
    return std::span(values).subspan(sample * sampleSize(), sampleSize());
  }
  // Returns the matrix of a channel, or the only one if all channels share it.
  std::span<const float> matrix(std::size_t sample, std::size_t channel) const {
    return at(sample).subspan((channels == 1 ? 0 : channel) * matrixSize(), matrixSize());
  }
};

// GlossyLight is what one pass brings to glossy samples, of the environment and of the group's lights. Only
// direct light of the environment has no colour, and one channel.
struct GlossyLight {
  GlossyMatrices environment, lights;
};

// The glossy surfaces of a group as senders of what the pass before brought them.
struct GlossyExit {
  const ExitKernels& kernels;  // of the triangles of glossy draws, in as many bands as the matrices
  std::size_t first_sample;    // that of SampleSet::glossy
  GlossyLight light = {};

  // Does what ExitRadiance::addGlossy does. `corners` are the triangle's samples. Returns albedo() of the
  // hit.
  glm::vec3 add(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to, float chance,
                float weight, std::span<float> sum) const;
  // Returns how much of uniform light the hit point reflects towards `to`, for each channel.
  glm::vec3 albedo(const GatherHit& hit, const glm::vec3& to) const;
};

}  // namespace lambent::baker
