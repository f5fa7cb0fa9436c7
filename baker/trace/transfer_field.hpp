// Holds diffuse transfer vectors at the samples of one group, before coding. They are in the group's frame,
// and leave out the receiver's own albedo: E_p/pi = sum_i t_p,i l_i (docs/conventions.md). The columns are
// order² for the environment, then one for each light of the group at unit strength.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/jobs/stage.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

struct TransferField {
  int order = 5;
  std::uint32_t outputs = 1;   // 9: transferred light in bands 0..2, for any normal (hemisphere.hpp)
  std::uint32_t channels = 1;  // 1 if red, green and blue are the same, else 3
  std::uint32_t columns = 25;
  std::vector<float> vectors;  // [((sample * outputs + output) * channels + channel) * columns + column]

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

// Packs direct transfer of ranges of samples into bytes. Light of the environment has no colour before it is
// reflected, unless it passes coloured panes, nor has that of grey lamps: what is the same for red, green and
// blue is kept once, so that traced results stay valid when a grey scene becomes a coloured one.

// Says which columns are the same in all channels: those of the environment, and those after them.
struct GreyColumns {
  bool sky, lights;
};

// Returns the direct transfer of a field as an output of a stage; its rows (rowOfItem) are samples.
Output directRows(TransferField& field, GreyColumns grey, std::ptrdiff_t first_row = 0);

// Fills in samples that lie inside or under something. They are dark, and interpolated, that darkness would
// leak out along the contact. They take the mean of their valid neighbours instead, layer by layer.
// `values` are those of the samples from `first` on, `size` for each. `valid` has one entry for each sample
// of the whole set. `edges` are those of sampleEdges(); edges to other samples do not count. Returns how many
// samples were filled. Samples that no valid sample is connected to keep their value.
std::uint32_t fillFromNeighbours(const SampleEdges& edges, std::span<const std::uint8_t> valid,
                                 std::size_t first, std::size_t size, std::span<float> values);

}  // namespace lambent::baker
