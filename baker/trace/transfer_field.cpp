#include "baker/trace/transfer_field.hpp"

#include <algorithm>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// Calls visit(offset, length) for each stretch of a sample's vector that is kept.
template <typename Visit>
void forCached(const TransferField& field, GreyColumns grey, const Visit& visit) {
  const auto bands = static_cast<std::size_t>(sh::coefficientCount(field.order));
  const std::size_t lights = field.columns - bands;
  for (std::size_t output = 0; output < field.outputs; ++output)
    for (std::size_t channel = 0; channel < field.channels; ++channel) {
      const std::size_t at = (output * field.channels + channel) * field.columns;
      if (channel == 0 || !grey.sky) visit(at, bands);
      if (channel == 0 || !grey.lights) visit(at + bands, lights);
    }
}

// Copies the first channel to the channels that were not kept.
void spread(const TransferField& field, GreyColumns grey, std::span<float> vector) {
  const auto bands = static_cast<std::size_t>(sh::coefficientCount(field.order));
  const std::size_t begin = grey.sky ? 0 : bands, end = grey.lights ? field.columns : bands;
  for (std::size_t output = 0; output < field.outputs; ++output) {
    const auto channels = vector.subspan(output * field.channels * field.columns);
    for (std::size_t channel = 1; channel < field.channels; ++channel)
      for (std::size_t i = begin; i < end; ++i) channels[channel * field.columns + i] = channels[i];
  }
}

void writeDirect(const TransferField& field, GreyColumns grey, std::size_t begin, std::size_t end,
                 ByteWriter& out) {
  std::vector<float> kept;
  for (std::size_t s = begin; s < end; ++s) {
    const auto vector = field.at(s);
    forCached(field, grey, [&](std::size_t at, std::size_t count) {
      const auto stretch = vector.subspan(at, count);
      kept.insert(kept.end(), stretch.begin(), stretch.end());
    });
  }
  out.addList(kept);
}

bool readDirect(ByteReader& in, GreyColumns grey, std::size_t begin, std::size_t end, TransferField& field) {
  std::vector<float> kept;
  std::size_t size = 0, at_kept = 0;
  forCached(field, grey, [&](std::size_t, std::size_t count) { size += count; });
  if (!in.readList(kept) || kept.size() != size * (end - begin)) return false;
  for (std::size_t s = begin; s < end; ++s) {
    const auto vector = field.at(s);
    forCached(field, grey, [&](std::size_t at, std::size_t count) {
      std::copy_n(kept.begin() + static_cast<std::ptrdiff_t>(at_kept), count,
                  vector.begin() + static_cast<std::ptrdiff_t>(at));
      at_kept += count;
    });
    spread(field, grey, vector);
  }
  return true;
}

}  // namespace

Output directRows(TransferField& field, GreyColumns grey, std::ptrdiff_t first_row) {
  const auto row = [first_row](std::size_t item) { return rowOfItem(item, first_row); };
  return {[&field, grey, row](std::size_t begin, std::size_t end, ByteWriter& out) {
            writeDirect(field, grey, row(begin), row(end), out);
          },
          [&field, grey, row](std::size_t begin, std::size_t end, ByteReader& in) {
            return readDirect(in, grey, row(begin), row(end), field);
          }};
}

std::uint32_t fillFromNeighbours(const SampleEdges& edges, std::span<const std::uint8_t> valid,
                                 std::size_t first, std::size_t size, std::span<float> values) {
  if (values.empty()) return 0;
  const auto shift = static_cast<std::uint32_t>(first),
             end = static_cast<std::uint32_t>(first + values.size() / size);
  SampleEdges own;
  for (const auto& [a, b] : edges)
    if (a >= shift && b >= shift && a < end && b < end) own.emplace_back(a - shift, b - shift);
  std::vector<std::uint8_t> known(valid.begin() + shift, valid.begin() + end);
  std::uint32_t filled = 0;
  const auto at = [&](std::uint32_t sample) { return values.subspan(sample * size, size); };
  // Each layer sees only the layers before it, so the order of samples does not matter.
  while (std::find(known.begin(), known.end(), 0) != known.end()) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> border;  // sample to fill, known neighbour
    for (const auto& [a, b] : own)
      if (known[a] != known[b]) border.emplace_back(known[a] ? b : a, known[a] ? a : b);
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
    for (const auto& entry : border) known[entry.first] = 1;
  }
  return filled;
}

}  // namespace lambent::baker
