#include "runtime/bundle/codebook.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

namespace lambent::bundle {

namespace {

constexpr const char* kMend = "copy it again or bake it again";
// A weight times a binary16 value (under 65536), summed over all axes that a vector can have, stays finite.
constexpr float kMaxWeight = 1e28f;

// 16-bit words as two runs of bytes, low and high: the entropy coder works on bytes, and the two kinds have
// nothing in common.
void appendSplit(std::vector<std::byte>& out, std::span<const std::uint16_t> words) {
  for (const std::uint16_t word : words) out.push_back(static_cast<std::byte>(word & 0xff));
  for (const std::uint16_t word : words) out.push_back(static_cast<std::byte>(word >> 8));
}

std::uint16_t splitWord(std::span<const std::byte> bytes, std::size_t count, std::size_t i) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[i]) |
                                    std::to_integer<unsigned>(bytes[count + i]) << 8);
}

void appendFloat(std::vector<std::byte>& out, float value) {
  std::byte bytes[sizeof(value)];
  std::memcpy(bytes, &value, sizeof(value));
  out.insert(out.end(), std::begin(bytes), std::end(bytes));
}

float floatAt(std::span<const std::byte> bytes, std::size_t i) {
  float value = 0.0f;
  std::memcpy(&value, bytes.data() + i * sizeof(value), sizeof(value));
  return value;
}

bool usable(const AxisCode& axis) {
  const float last = axis.offset + 65535.0f * axis.scale;  // NaN fails every comparison
  return std::abs(axis.offset) <= kMaxWeight && std::abs(last) <= kMaxWeight;
}

}  // namespace

// --- codebook: counts (u16), offsets (f32), scales (f32), vectors (binary16, split) ---

std::vector<std::byte> encodeCodebook(const Codebook& codebook) {
  std::vector<std::byte> out;
  std::vector<std::uint16_t> counts, halves;
  for (const std::uint32_t count : codebook.axis_counts) {
    assert(count <= std::numeric_limits<std::uint16_t>::max());
    counts.push_back(static_cast<std::uint16_t>(count));
  }
  for (const float value : codebook.vectors) halves.push_back(glm::packHalf1x16(value));
  appendSplit(out, counts);
  for (const AxisCode& axis : codebook.axes) appendFloat(out, axis.offset);
  for (const AxisCode& axis : codebook.axes) appendFloat(out, axis.scale);
  appendSplit(out, halves);
  return out;
}

Result<Codebook> decodeCodebook(std::span<const std::byte> bytes, const TransferShape& shape,
                                std::uint32_t clusters, const std::string& subject) {
  const auto damaged = [&](const char* why) {
    return fail(subject, fmt::format("has a damaged codebook: {}", why), kMend);
  };
  const std::uint64_t size = shape.size();
  if (clusters == 0 || size == 0) return damaged("it is of nothing");
  if (bytes.size() / 2 < clusters) return damaged("too short");
  Codebook codebook;
  std::uint64_t axes = 0;
  for (std::uint32_t c = 0; c < clusters; ++c) {
    const std::uint32_t count = splitWord(bytes, clusters, c);
    if (count > size) return damaged("a cluster has more axes than a vector has values");
    if (c > 0 && count > codebook.axis_counts.back()) return damaged("numbers of axes rise");
    codebook.axis_counts.push_back(count);
    axes += count;
  }
  // Under 2^63: at most 2^16 axes in each of 2^32 clusters; the division keeps the last product from
  // overflowing.
  std::span<const std::byte> rest = bytes.subspan(std::size_t{clusters} * 2);
  if (rest.size() / 8 < axes || (rest.size() - axes * 8) / 2 / size < axes + clusters ||
      rest.size() - axes * 8 != (axes + clusters) * size * 2)
    return damaged("sizes do not add up");

  for (std::size_t a = 0; a < axes; ++a) {
    const AxisCode axis{floatAt(rest, a), floatAt(rest, axes + a)};
    if (!usable(axis)) return damaged("a weight that is not finite");
    codebook.axes.push_back(axis);
  }
  rest = rest.subspan(axes * 8);
  codebook.vectors.resize((axes + clusters) * size);
  for (std::size_t i = 0; i < codebook.vectors.size(); ++i) {
    codebook.vectors[i] = glm::unpackHalf1x16(splitWord(rest, codebook.vectors.size(), i));
    if (!std::isfinite(codebook.vectors[i])) return damaged("a value is not finite");
  }
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
    return fail(subject, "has damaged cluster ids: wrong size", kMend);
  std::vector<std::uint32_t> cluster_of(sample_count);
  for (std::size_t s = 0; s < cluster_of.size(); ++s) {
    cluster_of[s] = wide ? splitWord(bytes, sample_count, s) : std::to_integer<std::uint32_t>(bytes[s]);
    if (cluster_of[s] >= clusters)
      return fail(subject, "has damaged cluster ids: a cluster that does not exist", kMend);
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
  std::vector<std::uint16_t> differences;
  std::uint32_t previous = 0;
  for (const std::uint32_t code : codes) {
    assert(code < (1u << bits));
    differences.push_back(static_cast<std::uint16_t>((code - previous) & ((1u << bits) - 1)));
    previous = code;
  }
  std::vector<std::byte> out;
  appendSplit(out, differences);
  if (bits == 8) out.resize(codes.size());
  return out;
}

Result<std::vector<std::uint32_t>> decodeWeightPlane(std::span<const std::byte> bytes, std::uint32_t bits,
                                                     std::uint32_t count, const std::string& subject) {
  if (bits != 8 && bits != 16) return fail(subject, "has a damaged weight plane: not of 8 or 16 bits", kMend);
  if (bytes.size() != std::size_t{count} * bits / 8)
    return fail(subject, "has a damaged weight plane: wrong size", kMend);
  std::vector<std::uint32_t> codes(count);
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    code += bits == 16 ? splitWord(bytes, count, i) : std::to_integer<std::uint32_t>(bytes[i]);
    code &= (1u << bits) - 1;
    codes[i] = code;
  }
  return codes;
}

// --- whole cells ---

std::vector<float> decodeTransfer(const TransferShape& shape, const Codebook& codebook,
                                  std::span<const std::uint32_t> cluster_of,
                                  std::span<const std::vector<std::uint32_t>> planes) {
  const std::size_t size = shape.size();
  std::vector<std::size_t> first_axis(codebook.clusters() + 1, 0);
  for (std::size_t c = 0; c < codebook.clusters(); ++c)
    first_axis[c + 1] = first_axis[c] + codebook.axis_counts[c];
  assert(codebook.axes.size() == first_axis.back() &&
         codebook.vectors.size() == (first_axis.back() + codebook.clusters()) * size);

  std::vector<float> out(cluster_of.size() * size);
  const auto sample_at = positionsOf(cluster_of, static_cast<std::uint32_t>(codebook.clusters()));
  for (std::size_t position = 0; position < sample_at.size(); ++position) {
    const std::size_t sample = sample_at[position], cluster = cluster_of[sample];
    const std::size_t axes = std::min<std::size_t>(codebook.axis_counts[cluster], planes.size());
    const float* mean = codebook.vectors.data() + (first_axis[cluster] + cluster) * size;
    float* vector = out.data() + sample * size;
    std::copy_n(mean, size, vector);
    for (std::size_t j = 0; j < axes; ++j) {
      const AxisCode& code = codebook.axes[first_axis[cluster] + j];
      const float weight = code.offset + code.scale * static_cast<float>(planes[j][position]);
      const float* axis = mean + (1 + j) * size;
      for (std::size_t i = 0; i < size; ++i) vector[i] += weight * axis[i];
    }
  }
  return out;
}

}  // namespace lambent::bundle
