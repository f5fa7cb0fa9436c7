#include "runtime/transfer/weights.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "runtime/base/payload_bytes.hpp"

namespace lambent::transfer {

namespace {

// First word of a rows payload. Format version 1 used 0 and 1 for samples that were not stored as
// differences.
constexpr std::uint32_t kSingleRows = 2, kSparseRows = 3;
constexpr std::uint32_t kWeightOne = 65535;

// Returns differences of successive samples. If a mesh uses its samples in order, these are 0 and 1, which
// compress to almost nothing.
std::vector<std::uint32_t> differences(std::span<const std::uint32_t> samples) {
  std::vector<std::uint32_t> out(samples.begin(), samples.end());
  std::adjacent_difference(out.begin(), out.end(), out.begin());
  return out;
}

// Appends the weights of a row as integers that sum to exactly 65535. The largest weight absorbs rounding
// errors.
void quantizeRow(std::span<const float> weights, std::vector<std::uint16_t>& out) {
  const std::size_t first = out.size();
  std::uint32_t sum = 0;
  for (const float weight : weights) {
    const auto q =
        static_cast<std::uint32_t>(std::lround(std::clamp(weight, 0.0f, 1.0f) * float{kWeightOne}));
    out.push_back(static_cast<std::uint16_t>(q));
    sum += q;
  }
  if (weights.empty()) return;
  const auto largest = std::max_element(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  *largest = static_cast<std::uint16_t>(*largest + kWeightOne - sum);
}

}  // namespace

std::vector<std::byte> encodeRows(const VertexWeights& rows) {
  const std::size_t vertex_count = rows.offsets.size() - 1;
  const bool single =
      rows.samples.size() == vertex_count &&
      std::all_of(rows.weights.begin(), rows.weights.end(), [](float w) { return w == 1.0f; });
  std::vector<std::byte> out;
  const std::uint32_t head[] = {single ? kSingleRows : kSparseRows,
                                static_cast<std::uint32_t>(rows.samples.size())};
  appendValues<std::uint32_t>(out, head);
  if (!single) appendValues<std::uint32_t>(out, rows.offsets);
  appendValues<std::uint32_t>(out, differences(rows.samples));
  if (!single) {
    std::vector<std::uint16_t> weights;
    for (std::size_t v = 0; v < vertex_count; ++v)
      quantizeRow(std::span(rows.weights).subspan(rows.offsets[v], rows.offsets[v + 1] - rows.offsets[v]),
                  weights);
    appendValues<std::uint16_t>(out, weights);
  }
  return out;
}

Result<VertexWeights> decodeRows(std::span<const std::byte> bytes, std::uint32_t vertex_count,
                                 std::uint32_t sample_count, const std::string& subject) {
  const auto damaged = [&](const char* why) {
    return fail(subject, fmt::format("has damaged vertex rows: {}", why), kCopyAgain);
  };
  if (bytes.size() < 8) return damaged("too short");
  Front front(bytes);
  const auto head = front.values<std::uint32_t>(2);
  const std::size_t entries = head[1];
  const bool single = head[0] == kSingleRows;
  if (!single && head[0] != kSparseRows) return damaged("of an unknown kind");
  const std::size_t vertices = vertex_count;
  const std::size_t expected = single ? entries * 4 : (vertices + 1) * 4 + entries * 6;
  if (front.left() != expected || (single && entries != vertices)) return damaged("sizes do not add up");

  VertexWeights rows;
  if (single) {
    rows.offsets.resize(vertices + 1);
    for (std::uint32_t v = 0; v <= vertex_count; ++v) rows.offsets[v] = v;
  } else {
    rows.offsets = front.values<std::uint32_t>(vertices + 1);
    if (rows.offsets.front() != 0 || rows.offsets.back() != entries ||
        !std::is_sorted(rows.offsets.begin(), rows.offsets.end()))
      return damaged("offsets do not rise from 0 to the number of entries");
  }
  rows.samples = front.values<std::uint32_t>(entries);
  std::partial_sum(rows.samples.begin(), rows.samples.end(), rows.samples.begin());
  for (const std::uint32_t sample : rows.samples)
    if (sample >= sample_count) return damaged("a sample that the group does not have");
  rows.weights.assign(entries, 1.0f);
  if (!single) {
    const auto weights = front.values<std::uint16_t>(entries);
    for (std::size_t e = 0; e < entries; ++e)
      rows.weights[e] = static_cast<float>(weights[e]) / float{kWeightOne};
  }
  return rows;
}

std::vector<std::byte> encodeLightWeights(std::span<const LightWeights> samples) {
  std::vector<std::byte> out;
  out.reserve(samples.size() * 2 * kLightsPerSample);
  for (std::size_t k = 0; k < kLightsPerSample; ++k)
    for (const LightWeights& sample : samples) out.push_back(static_cast<std::byte>(sample.light[k]));
  for (std::size_t k = 0; k < kLightsPerSample; ++k)
    for (const LightWeights& sample : samples) out.push_back(static_cast<std::byte>(sample.weight[k]));
  return out;
}

Result<std::vector<LightWeights>> decodeLightWeights(std::span<const std::byte> bytes,
                                                     std::size_t sample_count, std::size_t light_count,
                                                     const std::string& subject) {
  const auto damaged = [&](const char* why) {
    return fail(subject, std::string("has damaged light weights: ") + why, kCopyAgain);
  };
  if (bytes.size() / (2 * kLightsPerSample) != sample_count || bytes.size() % (2 * kLightsPerSample) != 0)
    return damaged("of another number of samples");
  std::vector<LightWeights> samples(sample_count);
  for (std::size_t i = 0; i < sample_count; ++i) {
    LightWeights& sample = samples[i];
    for (std::size_t k = 0; k < kLightsPerSample; ++k) {
      sample.light[k] = std::to_integer<std::uint8_t>(bytes[k * sample_count + i]);
      sample.weight[k] = std::to_integer<std::uint8_t>(bytes[(kLightsPerSample + k) * sample_count + i]);
      if (sample.light[k] >= light_count) return damaged("a light probe that the cell does not have");
    }
    if (std::accumulate(sample.weight.begin(), sample.weight.end(), 0u) != 255)
      return damaged("the weights of a sample do not sum to 255");
  }
  return samples;
}

}  // namespace lambent::transfer
