#include "runtime/transfer/codebook.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include "runtime/base/payload_bytes.hpp"

namespace lambent::transfer {

namespace {

// First word of a codebook payload.
constexpr std::uint32_t kPlainForm = 0, kSharedForm = 1;
// This is more than any cell needs. It keeps a small damaged file from demanding much memory.
constexpr std::uint64_t kMaxVectorValues = std::uint64_t{1} << 27;
// With these limits the sum of weight times value over all axes of a vector stays finite.
constexpr float kMaxWeight = 1e20f, kMaxValue = 1e12f;

bool usable(const AxisCode& axis) {
  const float last = axis.offset + 65535.0f * axis.scale;  // NaN fails every comparison
  return std::abs(axis.offset) <= kMaxWeight && std::abs(last) <= kMaxWeight;
}

// Appends the head that both forms share: form, axis counts, offsets and scales.
void appendHead(std::vector<std::byte>& out, std::uint32_t form, std::span<const std::uint32_t> axis_counts,
                std::span<const AxisCode> axes) {
  std::vector<std::uint16_t> counts;
  std::vector<float> codes;
  for (const std::uint32_t count : axis_counts) {
    assert(count <= std::numeric_limits<std::uint16_t>::max());
    counts.push_back(static_cast<std::uint16_t>(count));
  }
  for (const AxisCode& axis : axes) codes.push_back(axis.offset);
  for (const AxisCode& axis : axes) codes.push_back(axis.scale);
  appendValues<std::uint32_t>(out, std::span(&form, 1));
  appendSplit(out, counts);
  appendValues<float>(out, codes);
}

bool allBelow(std::span<const float> values, float limit) {  // NaN is not below anything
  return std::all_of(values.begin(), values.end(), [&](float v) { return std::abs(v) <= limit; });
}

bool allBelow(std::span<const std::int32_t> values) {
  return std::all_of(values.begin(), values.end(),
                     [](std::int32_t v) { return v > -kMaxCoordinate && v < kMaxCoordinate; });
}

}  // namespace

// --- codebook ---

std::vector<std::byte> encodeCodebook(const Codebook& codebook) {
  std::vector<std::byte> out;
  std::vector<std::uint16_t> halves;
  for (const float value : codebook.vectors) halves.push_back(glm::packHalf1x16(value));
  appendHead(out, kPlainForm, codebook.axis_counts, codebook.axes);
  appendSplit(out, halves);
  return out;
}

std::vector<std::byte> encodeCodebook(const SharedCodebook& codebook) {
  std::vector<std::byte> out;
  appendHead(out, kSharedForm, codebook.axis_counts, codebook.axes);
  const auto rank = static_cast<std::uint32_t>(codebook.basis_scales.size());
  appendValues<std::uint32_t>(out, std::span(&rank, 1));
  appendValues<float>(out, codebook.value_scales);
  appendValues<float>(out, codebook.basis_scales);
  appendValues<float>(out, std::span(&codebook.mean_scale, 1));
  appendIntegers(out, codebook.basis);
  appendIntegers(out, codebook.means);
  appendIntegers(out, codebook.directions);
  return out;
}

Codebook expand(const SharedCodebook& codebook) {
  const std::size_t size = codebook.value_scales.size(), rank = codebook.basis_scales.size(),
                    clusters = codebook.axis_counts.size(), axes = codebook.axes.size();
  Codebook out{codebook.axis_counts, codebook.axes, std::vector<float>((clusters + axes) * size, 0.0f)};
  std::vector<float> basis(rank * size);
  for (std::size_t r = 0; r < rank; ++r)
    for (std::size_t i = 0; i < size; ++i)
      basis[r * size + i] = codebook.value_scales[i] * codebook.basis_scales[r] *
                            static_cast<float>(codebook.basis[r * size + i]);
  float* vector = out.vectors.data();
  const auto put = [&](const std::int32_t* coordinates, std::size_t stride, float scale) {
    for (std::size_t r = 0; r < rank; ++r) {
      const float weight = scale * static_cast<float>(coordinates[r * stride]);
      if (weight == 0.0f) continue;
      for (std::size_t i = 0; i < size; ++i) vector[i] += weight * basis[r * size + i];
    }
    vector += size;
  };
  std::vector<std::size_t> sharing;  // number of clusters that have an axis j, for each j
  for (std::size_t c = 0; c < clusters; ++c)
    for (std::uint32_t j = 0; j < codebook.axis_counts[c]; ++j) {
      if (sharing.size() <= j) sharing.push_back(0);
      ++sharing[j];
    }
  for (std::size_t c = 0; c < clusters; ++c) {
    put(codebook.means.data() + c, clusters, codebook.mean_scale);
    const std::int32_t* directions = codebook.directions.data();
    for (std::uint32_t j = 0; j < codebook.axis_counts[c]; ++j) {
      put(directions + c, sharing[j], 1.0f);
      directions += rank * sharing[j];
    }
  }
  return out;
}

Result<Codebook> decodeCodebook(std::span<const std::byte> bytes, const TransferShape& shape,
                                std::uint32_t clusters, const std::string& subject) {
  const auto damaged = [&](const char* why) {
    return fail(subject, fmt::format("has a damaged codebook: {}", why), kCopyAgain);
  };
  const std::uint64_t size = shape.size();
  if (clusters == 0 || size == 0) return damaged("it is of nothing");
  Front front(bytes);
  const auto form = front.values<std::uint32_t>(1);
  const auto counts = front.split(clusters);
  if (counts.empty() || form[0] > kSharedForm) return damaged("too short, or of an unknown form");
  Codebook codebook;
  codebook.axis_counts.assign(counts.begin(), counts.end());
  if (counts.front() > size) return damaged("a cluster has more axes than a vector has values");
  if (!std::is_sorted(counts.rbegin(), counts.rend())) return damaged("numbers of axes rise");
  const std::uint64_t axes = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  const auto codes = front.values<float>(2 * axes);
  for (std::size_t a = 0; a < codes.size() / 2; ++a) {
    codebook.axes.push_back({codes[a], codes[axes + a]});
    if (!usable(codebook.axes.back())) return damaged("a weight that is not finite");
  }

  if (axes + clusters > kMaxVectorValues / size) return damaged("too many axes");
  if (form[0] == kPlainForm) {
    const auto halves = front.split((axes + clusters) * size);
    if (!front.whole()) return damaged("sizes do not add up");
    for (const std::uint16_t half : halves) codebook.vectors.push_back(glm::unpackHalf1x16(half));
  } else {
    SharedCodebook shared{
        std::move(codebook.axis_counts), std::move(codebook.axes), {}, {}, 0.0f, {}, {}, {}};
    const auto rank = front.values<std::uint32_t>(1);
    if (rank.empty() || rank[0] > size) return damaged("sizes do not add up");
    shared.value_scales = front.values<float>(size);
    shared.basis_scales = front.values<float>(rank[0]);
    const auto mean_scale = front.values<float>(1);
    shared.basis = front.integers(rank[0] * size);
    shared.means = front.integers(std::uint64_t{rank[0]} * clusters);
    shared.directions = front.integers(std::uint64_t{rank[0]} * axes);
    if (!front.whole()) return damaged("sizes do not add up");
    shared.mean_scale = mean_scale[0];
    if (!allBelow(shared.value_scales, kMaxValue) || !allBelow(shared.basis_scales, kMaxValue) ||
        !allBelow(mean_scale, kMaxValue) || !allBelow(shared.basis) || !allBelow(shared.means) ||
        !allBelow(shared.directions))
      return damaged("a value is not finite");
    codebook = expand(shared);
  }
  if (!allBelow(codebook.vectors, kMaxValue)) return damaged("a value is not finite");
  return codebook;
}

// --- cluster ids ---

std::vector<std::byte> encodeClusterIds(std::span<const std::uint32_t> cluster_of, std::uint32_t clusters) {
  assert(clusters > 0 && clusters <= 65536);
  std::vector<std::uint16_t> ids;
  for (const std::uint32_t id : cluster_of) {
    assert(id < clusters);
    ids.push_back(static_cast<std::uint16_t>(id));
  }
  std::vector<std::byte> out;
  appendSplit(out, ids);
  if (clusters <= 256) out.resize(ids.size());
  return out;
}

Result<std::vector<std::uint32_t>> decodeClusterIds(std::span<const std::byte> bytes, std::uint32_t clusters,
                                                    std::uint32_t sample_count, const std::string& subject) {
  const bool wide = clusters > 256;
  if (bytes.size() != std::size_t{sample_count} * (wide ? 2 : 1))
    return fail(subject, "has damaged cluster ids: wrong size", kCopyAgain);
  std::vector<std::uint32_t> cluster_of(sample_count);
  for (std::size_t s = 0; s < cluster_of.size(); ++s) {
    cluster_of[s] = wide ? splitWord(bytes, sample_count, s) : std::to_integer<std::uint32_t>(bytes[s]);
    if (cluster_of[s] >= clusters)
      return fail(subject, "has damaged cluster ids: a cluster that does not exist", kCopyAgain);
  }
  return cluster_of;
}

// --- order of codes ---

std::vector<std::uint32_t> positionsOf(std::span<const std::uint32_t> cluster_of, std::uint32_t clusters) {
  std::vector<std::uint32_t> next(std::size_t{clusters} + 1, 0);
  for (const std::uint32_t id : cluster_of) ++next[id + 1];
  for (std::size_t c = 0; c < clusters; ++c) next[c + 1] += next[c];
  std::vector<std::uint32_t> sample_at(cluster_of.size());
  for (std::uint32_t s = 0; s < cluster_of.size(); ++s) sample_at[next[cluster_of[s]]++] = s;
  return sample_at;
}

std::vector<std::uint32_t> planeCounts(const Codebook& codebook, std::span<const std::uint32_t> cluster_of) {
  std::vector<std::uint32_t> counts(codebook.axis_counts.empty() ? 0 : codebook.axis_counts.front(), 0);
  for (const std::uint32_t id : cluster_of)
    if (codebook.axis_counts[id] > 0) ++counts[codebook.axis_counts[id] - 1];
  for (std::size_t j = counts.size(); j-- > 1;) counts[j - 1] += counts[j];
  return counts;
}

// --- weight planes ---

std::vector<std::byte> encodeWeightPlane(std::span<const std::uint32_t> codes, std::uint32_t bits) {
  assert(bits == 8 || bits == 16);
  std::vector<std::uint16_t> words;
  std::uint32_t previous = 0;
  for (const std::uint32_t code : codes) {
    assert(code < (1u << bits));
    const auto difference = static_cast<std::int32_t>((code - previous) << (32 - bits)) >> (32 - bits);
    words.push_back(static_cast<std::uint16_t>(zigzag(difference)));  // fits: |difference| <= 2^(bits-1)
    previous = code;
  }
  std::vector<std::byte> out;
  appendSplit(out, words);
  if (bits == 8) out.resize(codes.size());
  return out;
}

Result<std::vector<std::uint32_t>> decodeWeightPlane(std::span<const std::byte> bytes, std::uint32_t bits,
                                                     std::uint32_t count, const std::string& subject) {
  if (bits != 8 && bits != 16)
    return fail(subject, "has a damaged weight plane: not of 8 or 16 bits", kCopyAgain);
  if (bytes.size() != std::size_t{count} * bits / 8)
    return fail(subject, "has a damaged weight plane: wrong size", kCopyAgain);
  std::vector<std::uint32_t> codes(count);
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::uint32_t word =
        bits == 16 ? splitWord(bytes, count, i) : std::to_integer<std::uint32_t>(bytes[i]);
    code = (code + static_cast<std::uint32_t>(unzigzag(word))) & ((1u << bits) - 1);
    codes[i] = code;
  }
  return codes;
}

// --- whole cells ---

std::vector<float> decodeTransfer(const TransferShape& shape, const Codebook& codebook,
                                  std::span<const std::uint32_t> cluster_of,
                                  std::span<const std::vector<std::uint32_t>> planes, const RunRanges& run) {
  const std::size_t size = shape.size();
  std::vector<std::size_t> first_axis(codebook.clusters() + 1, 0);
  for (std::size_t c = 0; c < codebook.clusters(); ++c)
    first_axis[c + 1] = first_axis[c] + codebook.axis_counts[c];
  assert(codebook.axes.size() == first_axis.back() &&
         codebook.vectors.size() == (first_axis.back() + codebook.clusters()) * size);
  const auto sample_at = positionsOf(cluster_of, static_cast<std::uint32_t>(codebook.clusters()));
  std::vector<float> out(cluster_of.size() * size);
  run(cluster_of.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t position = begin; position < end; ++position) {
      const std::size_t sample = sample_at[position], cluster = cluster_of[sample];
      const std::size_t axes = std::min<std::size_t>(codebook.axis_counts[cluster], planes.size());
      const float* mean = codebook.vectors.data() + (first_axis[cluster] + cluster) * size;
      float* vector = out.data() + sample * size;
      std::copy_n(mean, size, vector);
      const auto weight = [&](std::size_t j) {
        const AxisCode& code = codebook.axes[first_axis[cluster] + j];
        return code.offset + code.scale * static_cast<float>(planes[j][position]);
      };
      std::size_t j = 0;
      for (; j + 4 <= axes; j += 4) {  // four at a time, since the sum is loaded and stored for each pass
        const std::array<float, 4> w = {weight(j), weight(j + 1), weight(j + 2), weight(j + 3)};
        const float* axis = mean + (1 + j) * size;
        for (std::size_t i = 0; i < size; ++i) {
          float sum = vector[i];
          for (std::size_t k = 0; k < w.size(); ++k) sum += w[k] * axis[k * size + i];
          vector[i] = sum;
        }
      }
      for (; j < axes; ++j) {
        const float w = weight(j), *axis = mean + (1 + j) * size;
        for (std::size_t i = 0; i < size; ++i) vector[i] += w * axis[i];
      }
    }
  });
  return out;
}

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
