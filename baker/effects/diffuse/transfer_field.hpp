// Diffuse transfer vectors at the samples of one group, before coding. In the group's frame; the receiver's
// own albedo left out: E_p/pi = sum_i t_p,i l_i (docs/conventions.md).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lambent::baker {

struct TransferField {
  int order = 5;
  std::uint32_t channels = 1, columns = 25;
  std::vector<float> vectors;  // [(sample * channels + channel) * columns + column]

  std::uint64_t rays = 0;            // traced
  std::uint32_t filled_samples = 0;  // lay inside something: taken from their neighbours

  std::size_t vectorSize() const { return std::size_t{channels} * columns; }
  std::span<float> at(std::size_t sample) {
    return std::span(vectors).subspan(sample * vectorSize(), vectorSize());
  }
  std::span<const float> at(std::size_t sample) const {
    return std::span(vectors).subspan(sample * vectorSize(), vectorSize());
  }
};

}  // namespace lambent::baker
