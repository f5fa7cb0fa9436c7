#include "baker/trace/fill.hpp"

#include <algorithm>

namespace lambent::baker {

using SampleEdges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::uint32_t fillFromNeighbours(const SampleEdges& edges, std::vector<std::uint8_t> valid, std::size_t size,
                                 std::span<float> values) {
  std::uint32_t filled = 0;
  const auto at = [&](std::uint32_t sample) { return values.subspan(sample * size, size); };
  // Each layer sees only the layers before it, so the order of samples does not matter.
  while (std::find(valid.begin(), valid.end(), 0) != valid.end()) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> border;  // invalid sample, valid neighbour
    for (const auto& [a, b] : edges)
      if (valid[a] != valid[b]) border.emplace_back(valid[a] ? b : a, valid[a] ? a : b);
    if (border.empty()) break;
    std::sort(border.begin(), border.end());
    for (std::size_t i = 0; i < border.size();) {
      const std::uint32_t sample = border[i].first;
      std::vector<double> sum(size, 0.0);
      double count = 0.0;
      for (; i < border.size() && border[i].first == sample; ++i, ++count)
        for (std::size_t k = 0; k < size; ++k) sum[k] += double{at(border[i].second)[k]};
      for (std::size_t k = 0; k < size; ++k) at(sample)[k] = static_cast<float>(sum[k] / count);
      ++filled;
    }
    for (const auto& entry : border) valid[entry.first] = 1;
  }
  return filled;
}

std::uint32_t fillFromNeighbours(const SampleEdges& edges, std::vector<std::uint8_t> valid,
                                 TransferField& field) {
  return fillFromNeighbours(edges, std::move(valid), field.vectorSize(), field.vectors);
}

std::uint32_t fillStretchFromNeighbours(const SampleEdges& edges, const std::vector<std::uint8_t>& valid,
                                        std::size_t first, std::size_t size, std::span<float> values) {
  if (values.empty()) return 0;
  const auto shift = static_cast<std::uint32_t>(first),
             end = static_cast<std::uint32_t>(first + values.size() / size);
  SampleEdges own;
  for (const auto& [a, b] : edges)
    if (a >= shift && b >= shift && a < end && b < end) own.emplace_back(a - shift, b - shift);
  return fillFromNeighbours(own, {valid.begin() + shift, valid.begin() + end}, size, values);
}

}  // namespace lambent::baker
