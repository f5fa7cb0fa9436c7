// Holds diffuse transfer vectors at the samples of one group, before coding. They are in the group's frame,
// and leave out the receiver's own albedo: E_p/pi = sum_i t_p,i l_i (docs/conventions.md). The columns are
// order² for the environment, then one for each light of the group at unit strength.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lambent::baker {

struct TransferField {
  int order = 5;
  std::uint32_t outputs = 1;   // 9: transferred light in bands 0..2, for any normal (incident_basis.hpp)
  std::uint32_t channels = 1;  // 1 if red, green and blue are the same, else 3
  std::uint32_t columns = 25;
  std::vector<float> vectors;  // [((sample * outputs + output) * channels + channel) * columns + column]

  std::uint64_t rays = 0;            // traced
  std::uint32_t filled_samples = 0;  // number of samples inside something, filled from their neighbours

  std::size_t vectorSize() const { return std::size_t{outputs} * channels * columns; }
  std::size_t size() const { return vectors.size() / vectorSize(); }
  // Returns zeros of the same layout for so many samples.
  TransferField zeros(std::size_t samples) const {
    return {.order = order,
            .outputs = outputs,
            .channels = channels,
            .columns = columns,
            .vectors = std::vector<float>(samples * vectorSize(), 0.0f)};
  }
  std::span<float> at(std::size_t sample) {
    return std::span(vectors).subspan(sample * vectorSize(), vectorSize());
  }
  std::span<const float> at(std::size_t sample) const {
    return std::span(vectors).subspan(sample * vectorSize(), vectorSize());
  }
};

}  // namespace lambent::baker
