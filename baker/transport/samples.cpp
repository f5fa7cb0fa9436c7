#include "baker/transport/samples.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include <glm/geometric.hpp>

namespace lambent::baker {

namespace {

// --- welding
// ---------------------------------------------------------------------------------------------------

using VertexKey = std::array<std::uint32_t, 6>;  // bits of position and normal

struct VertexKeyHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const std::uint32_t word : key) hash = (hash ^ word) * 0xD6E8FEB86659FD93u, hash ^= hash >> 32;
    return hash;
  }
};

VertexKey keyOf(glm::vec3 position, glm::vec3 normal) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return {bits(position.x), bits(position.y), bits(position.z),
          bits(normal.x),   bits(normal.y),   bits(normal.z)};
}

// --- Morton order
// ----------------------------------------------------------------------------------------------

// Spreads the low 21 bits so that two zero bits follow each.
std::uint64_t spread3(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

std::uint64_t mortonCode(glm::vec3 position, glm::vec3 low, float cells_per_metre) {
  const glm::vec3 grid = glm::clamp((position - low) * cells_per_metre, 0.0f, 2097151.0f);
  return spread3(static_cast<std::uint64_t>(grid.x)) | spread3(static_cast<std::uint64_t>(grid.y)) << 1 |
         spread3(static_cast<std::uint64_t>(grid.z)) << 2;
}

// The order of `positions` along the curve; ties keep their order.
std::vector<std::uint32_t> mortonOrder(std::span<const glm::vec3> positions, glm::vec3 low, glm::vec3 high) {
  const glm::vec3 extent = high - low;
  const float longest = std::max({extent.x, extent.y, extent.z});
  const float cells_per_metre = longest > 0.0f ? 2097151.0f / longest : 0.0f;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> codes(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    codes[i] = {mortonCode(positions[i], low, cells_per_metre), static_cast<std::uint32_t>(i)};
  std::sort(codes.begin(), codes.end());
  std::vector<std::uint32_t> order(positions.size());
  std::transform(codes.begin(), codes.end(), order.begin(), [](const auto& code) { return code.second; });
  return order;
}

void weld(const GroupGeometry& geometry, SampleSet& samples) {
  std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash> seen;
  seen.reserve(geometry.positions.size());
  std::vector<glm::vec3> positions, normals;
  samples.vertex_sample.resize(geometry.positions.size());
  for (std::size_t v = 0; v < geometry.positions.size(); ++v) {
    const auto [entry, is_new] = seen.try_emplace(keyOf(geometry.positions[v], geometry.normals[v]),
                                                  static_cast<std::uint32_t>(positions.size()));
    if (is_new) {
      positions.push_back(geometry.positions[v]);
      normals.push_back(geometry.normals[v]);
    }
    samples.vertex_sample[v] = entry->second;
  }

  const auto order = mortonOrder(positions, geometry.bounds_min, geometry.bounds_max);
  std::vector<std::uint32_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = static_cast<std::uint32_t>(i);
    samples.positions.push_back(positions[order[i]]);
    samples.normals.push_back(normals[order[i]]);
  }
  for (std::uint32_t& sample : samples.vertex_sample) sample = place[sample];
}

// --- origins
// ---------------------------------------------------------------------------------------------------

float cornerAngle(glm::vec3 corner, glm::vec3 a, glm::vec3 b) {
  const glm::vec3 u = a - corner, v = b - corner;
  return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
}

// How far an origin stands off its face: what float rounding of positions and rays needs, and a little of the
// face's size; never a fixed length.
float standOff(glm::vec3 position, float face_size) {
  const float magnitude = std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)});
  return 1e-4f * face_size + 4e-6f * magnitude;
}

struct Corner {
  std::uint32_t sample, triangle, corner;
};

void findOrigins(const GroupGeometry& geometry, SampleSet& samples) {
  samples.origin_offsets.assign(samples.size() + 1, 0);
  std::vector<Corner> corners;
  corners.reserve(geometry.triangles.size() * 3);
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t)
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t sample = samples.vertex_sample[geometry.triangles[t][static_cast<int>(c)]];
      corners.push_back({sample, t, c});
    }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.sample < b.sample; });

  for (const Corner& corner : corners) {
    const glm::uvec3 triangle = geometry.triangles[corner.triangle];
    const int c = static_cast<int>(corner.corner);
    const glm::vec3 p = geometry.positions[triangle[c]];
    const glm::vec3 q = geometry.positions[triangle[(c + 1) % 3]],
                    r = geometry.positions[triangle[(c + 2) % 3]];
    const glm::vec3 area_normal = glm::cross(q - p, r - p);
    const float twice_area = glm::length(area_normal);
    const float angle = cornerAngle(p, q, r);
    if (!(twice_area > 0.0f) || !(angle > 0.0f)) continue;  // a degenerate face has no inside to stand on
    const glm::vec3 normal = area_normal / twice_area;
    const glm::vec3 pulled = p + kPullIntoFace * ((p + q + r) / 3.0f - p);
    samples.origins.push_back({pulled + standOff(p, std::sqrt(0.5f * twice_area)) * normal, normal, angle});
    ++samples.origin_offsets[corner.sample + 1];
  }
  std::partial_sum(samples.origin_offsets.begin(), samples.origin_offsets.end(),
                   samples.origin_offsets.begin());

  for (std::size_t s = 0; s < samples.size(); ++s) {
    const auto own =
        std::span(samples.origins).subspan(samples.origin_offsets[s], samples.originsOf(s).size());
    float sum = 0.0f;
    for (const SampleOrigin& origin : own) sum += origin.weight;
    for (SampleOrigin& origin : own) origin.weight /= sum;
  }
}

void cutCells(SampleSet& samples) {
  for (std::size_t first = 0; first < samples.size(); first += kMaxCellSamples) {
    SampleCell cell;
    cell.first = static_cast<std::uint32_t>(first);
    cell.count = static_cast<std::uint32_t>(std::min<std::size_t>(kMaxCellSamples, samples.size() - first));
    cell.bounds_min = cell.bounds_max = samples.positions[first];
    for (std::size_t s = first; s < first + cell.count; ++s) {
      cell.bounds_min = glm::min(cell.bounds_min, samples.positions[s]);
      cell.bounds_max = glm::max(cell.bounds_max, samples.positions[s]);
    }
    samples.cells.push_back(cell);
  }
}

}  // namespace

SampleSet buildSamples(const GroupGeometry& geometry) {
  SampleSet samples;
  weld(geometry, samples);
  findOrigins(geometry, samples);
  cutCells(samples);
  return samples;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> sampleEdges(const GroupGeometry& geometry,
                                                                 const SampleSet& samples) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(geometry.triangles.size() * 3);
  for (const glm::uvec3& triangle : geometry.triangles)
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t a = samples.vertex_sample[triangle[c]],
                          b = samples.vertex_sample[triangle[(c + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace lambent::baker
