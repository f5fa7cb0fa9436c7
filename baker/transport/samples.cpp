#include "baker/transport/samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/transport/geometry_key.hpp"
#include "baker/transport/texel_samples.hpp"

namespace lambent::baker {

namespace {

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

// Sorts the samples listed along the curve; ties keep their order.
void sortAlongMorton(std::span<const glm::vec3> positions, const GroupGeometry& geometry,
                     std::vector<std::uint32_t>& list) {
  const glm::vec3 low = geometry.bounds_min, extent = geometry.bounds_max - low;
  const float longest = std::max({extent.x, extent.y, extent.z});
  const float cells_per_metre = longest > 0.0f ? 2097151.0f / longest : 0.0f;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> codes;
  for (const std::uint32_t i : list) codes.emplace_back(mortonCode(positions[i], low, cells_per_metre), i);
  std::sort(codes.begin(), codes.end());
  std::transform(codes.begin(), codes.end(), list.begin(), [](const auto& code) { return code.second; });
}

// Welded holds one sample per key, in the order of first use.
struct Welded {
  std::vector<glm::vec3> positions, normals;
  std::vector<SampleKind> kinds;
};

Welded weld(const GroupGeometry& geometry, SampleSet& samples) {
  Welded welded;
  std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash> seen;
  seen.reserve(geometry.positions.size());
  samples.vertex_sample.resize(geometry.positions.size());
  for (const DrawGeometry& draw : geometry.draws)
    for (std::uint32_t v = draw.first_vertex; v < draw.first_vertex + draw.vertex_count; ++v) {
      const glm::vec3 position = geometry.positions[v], normal = geometry.normals[v];
      const auto [entry, is_new] = seen.try_emplace(vertexKey(position, normal, draw.kind),
                                                    static_cast<std::uint32_t>(welded.positions.size()));
      if (is_new) {
        welded.positions.push_back(position);
        welded.normals.push_back(normal);
        welded.kinds.push_back(draw.kind);
      }
      samples.vertex_sample[v] = entry->second;
    }
  return welded;
}

// Cuts the samples listed into cells and appends them to the set, each cell in the order of first use.
// `place` receives the new index of each.
void appendCells(const Welded& welded, std::vector<std::uint32_t> list, SampleKind kind,
                 const GroupGeometry& geometry, SampleSet& samples, std::vector<std::uint32_t>& place) {
  if (list.size() > kMaxCellSamples) sortAlongMorton(welded.positions, geometry, list);
  for (std::size_t first = 0; first < list.size(); first += kMaxCellSamples) {
    const std::size_t count = std::min<std::size_t>(kMaxCellSamples, list.size() - first);
    const auto members = std::span(list).subspan(first, count);
    std::sort(members.begin(), members.end());
    const glm::vec3 start = welded.positions[members.front()];
    SampleCell cell{.first = static_cast<std::uint32_t>(samples.size()),
                    .count = static_cast<std::uint32_t>(count),
                    .bounds_min = start,
                    .bounds_max = start,
                    .kind = kind};
    for (const std::uint32_t member : members) {
      place[member] = static_cast<std::uint32_t>(samples.size());
      samples.positions.push_back(welded.positions[member]);
      samples.normals.push_back(welded.normals[member]);
      cell.bounds_min = glm::min(cell.bounds_min, welded.positions[member]);
      cell.bounds_max = glm::max(cell.bounds_max, welded.positions[member]);
    }
    samples.cells.push_back(cell);
  }
}

// Adds the samples of texels after those of vertices. Returns where they lie, map by map.
std::vector<TexelPoint> addTexels(const GroupGeometry& geometry, Welded& welded, SampleSet& samples) {
  std::vector<TexelPoint> all;
  for (std::uint32_t d = 0; d < geometry.draws.size(); ++d) {
    const DrawGeometry& draw = geometry.draws[d];
    if (draw.texels == 0) continue;
    const std::size_t texels = std::size_t{draw.texels} * draw.texels;
    TexelMap& map = samples.texels.emplace_back(
        TexelMap{.draw = d,
                 .side = draw.texels,
                 .first_triangle = draw.first_triangle,
                 .triangle_count = draw.triangle_count,
                 .sample_of = std::vector<std::uint32_t>(texels, kNoSample),
                 .triangle_of = std::vector<std::uint32_t>(texels, draw.first_triangle)});
    for (const TexelPoint& point : texelPoints(geometry, draw)) {
      const FacePoint at = facePoint(geometry, geometry.triangles[point.triangle], point.shares);
      map.sample_of[point.texel] = static_cast<std::uint32_t>(welded.positions.size());
      map.triangle_of[point.texel] = point.triangle;
      welded.positions.push_back(at.position);
      welded.normals.push_back(at.normal);
      welded.kinds.push_back(SampleKind::Diffuse);
      all.push_back(point);
    }
  }
  return all;
}

// Returns where the samples of texels lie.
std::vector<TexelPoint> placeSamples(const GroupGeometry& geometry, bool with_texels, SampleSet& samples) {
  Welded welded = weld(geometry, samples);
  std::vector<TexelPoint> texels;
  if (with_texels) texels = addTexels(geometry, welded, samples);
  std::array<std::vector<std::uint32_t>, 3> lists;
  for (std::uint32_t i = 0; i < welded.positions.size(); ++i)
    lists[static_cast<std::size_t>(welded.kinds[i])].push_back(i);
  std::vector<std::uint32_t> place(welded.positions.size());
  const auto append = [&](SampleKind kind) {
    const std::size_t begin = samples.size();
    appendCells(welded, std::move(lists[static_cast<std::size_t>(kind)]), kind, geometry, samples, place);
    return SampleStretch{begin, samples.size()};
  };
  samples.diffuse = append(SampleKind::Diffuse);
  samples.normal_mapped = append(SampleKind::NormalMapped);
  samples.glossy = append(SampleKind::Glossy);
  for (std::uint32_t& sample : samples.vertex_sample) sample = place[sample];
  for (TexelMap& map : samples.texels)
    for (std::uint32_t& sample : map.sample_of)
      if (sample != kNoSample) sample = place[sample];
  return texels;
}

constexpr float kLongestReach = 0.01f;  // share of the group's diagonal

float cornerAngle(glm::vec3 corner, glm::vec3 a, glm::vec3 b) {
  const glm::vec3 u = a - corner, v = b - corner;
  return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
}

// A Corner is what a sample sees from: a corner of a triangle, or the point of a texel.
struct Corner {
  std::uint32_t sample, triangle, corner;
  const TexelPoint* texel = nullptr;
};

// Appends the points of texels, which are in the order of the maps.
void addTexelCorners(std::span<const TexelPoint> texels, const SampleSet& samples,
                     std::vector<Corner>& corners) {
  auto point = texels.begin();
  for (const TexelMap& map : samples.texels)
    for (const std::uint32_t sample : map.sample_of)
      if (sample != kNoSample) corners.push_back({sample, point->triangle, 0, &*point}), ++point;
}

// A texel's origin stands above its point. Something that lies on the texel hides it; it is filled from its
// neighbours then, and does not look for a place far away.
void addTexelOrigin(const GroupGeometry& geometry, const Corner& corner, SampleSet& samples) {
  const TexelPoint& texel = *corner.texel;
  const FacePoint at = facePoint(geometry, geometry.triangles[texel.triangle], texel.shares);
  SampleOrigin origin = at.origin;
  if (!(glm::dot(at.normal, origin.geometric_normal) > 0.0f)) return;
  origin.position = at.position + standOff(at.position, texel.size_m) * origin.geometric_normal;
  origin.reach = std::min(origin.reach, texel.size_m);
  samples.origins.push_back(origin);
  ++samples.origin_offsets[corner.sample + 1];
}

void findOrigins(const GroupGeometry& geometry, std::span<const TexelPoint> texels, SampleSet& samples) {
  samples.origin_offsets.assign(samples.size() + 1, 0);
  std::vector<Corner> corners;
  corners.reserve(geometry.triangles.size() * 3);
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t)
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t sample = samples.vertex_sample[geometry.triangles[t][static_cast<int>(c)]];
      corners.push_back({sample, t, c});
    }
  addTexelCorners(texels, samples, corners);
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.sample < b.sample; });

  std::vector<std::uint8_t> faces_up(samples.size(), 0);  // 1 if any face agrees with the sample's normal
  for (const Corner& corner : corners) {
    const glm::vec3 area_normal = areaNormal(geometry, geometry.triangles[corner.triangle]);
    if (glm::dot(area_normal, samples.normals[corner.sample]) > 0.0f) faces_up[corner.sample] = 1;
  }
  for (const Corner& corner : corners) {
    if (corner.texel) {
      addTexelOrigin(geometry, corner, samples);
      continue;
    }
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
    if (faces_up[corner.sample] != 0 && !(glm::dot(normal, samples.normals[corner.sample]) > 0.0f)) continue;
    const glm::vec3 middle = (p + q + r) / 3.0f, pulled = p + kPullIntoFace * (middle - p);
    samples.origins.push_back({.position = pulled + standOff(p, std::sqrt(0.5f * twice_area)) * normal,
                               .geometric_normal = normal,
                               .weight = angle,
                               .reach = reachOf(triangle, geometry),
                               .inward = middle - pulled});
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

}  // namespace

float standOff(const glm::vec3& position, float face_size) {
  const float magnitude = std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)});
  return 1e-4f * face_size + 4e-6f * magnitude;
}

float reachOf(const glm::uvec3& corners, const GroupGeometry& geometry) {
  return std::min(longestEdge(geometry, corners),
                  kLongestReach * glm::distance(geometry.bounds_min, geometry.bounds_max));
}

SampleSet buildSamples(const GroupGeometry& geometry, bool with_texels) {
  SampleSet samples;
  const std::vector<TexelPoint> texels = placeSamples(geometry, with_texels, samples);
  findOrigins(geometry, texels, samples);
  return samples;
}

SampleEdges sampleEdges(const GroupGeometry& geometry, const SampleSet& samples) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  if (samples.vertex_sample.empty()) return edges;
  edges.reserve(geometry.triangles.size() * 3);
  for (const glm::uvec3& triangle : geometry.triangles)
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t a = samples.vertex_sample[triangle[c]],
                          b = samples.vertex_sample[triangle[(c + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  for (const TexelMap& map : samples.texels) {
    const auto of_map = texelEdges(geometry, map);
    edges.insert(edges.end(), of_map.begin(), of_map.end());
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<float> sampleAreas(const GroupGeometry& geometry, const SampleSet& samples) {
  std::vector<float> areas(samples.size(), 0.0f);
  std::vector<std::uint32_t> texels_of(samples.texels.empty() ? 0 : geometry.triangles.size(), 0);
  for (const TexelMap& map : samples.texels)
    for (std::size_t i = 0; i < map.sample_of.size(); ++i)
      if (map.sample_of[i] != kNoSample) ++texels_of[map.triangle_of[i]];
  for (const TexelMap& map : samples.texels)
    for (std::size_t i = 0; i < map.sample_of.size(); ++i)
      if (const std::uint32_t t = map.triangle_of[i]; map.sample_of[i] != kNoSample)
        areas[map.sample_of[i]] +=
            static_cast<float>(triangleArea(geometry, geometry.triangles[t]) / texels_of[t]);
  for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
    if (!texels_of.empty() && texels_of[t] > 0) continue;  // it is that of its texels
    const glm::uvec3& triangle = geometry.triangles[t];
    const glm::vec3 a = geometry.positions[triangle.x], b = geometry.positions[triangle.y],
                    c = geometry.positions[triangle.z];
    const float third = glm::length(glm::cross(b - a, c - a)) / 6.0f;
    for (int corner = 0; corner < 3; ++corner) areas[samples.vertex_sample[triangle[corner]]] += third;
  }
  return areas;
}

FacePoint facePoint(const GroupGeometry& geometry, const glm::uvec3& corners, const glm::vec3& weights) {
  const glm::vec3 a = geometry.positions[corners.x], b = geometry.positions[corners.y],
                  c = geometry.positions[corners.z];
  const glm::vec3 across = glm::cross(b - a, c - a);
  const float twice_area = glm::length(across);
  const glm::vec3 face = across / twice_area;
  const glm::vec3 at = weights.x * a + weights.y * b + weights.z * c;
  const glm::vec3 normal = interpolatedNormal(geometry, corners, weights);
  return {.position = at,
          .normal = normal == glm::vec3(0.0f) ? face : normal,
          .origin = {.position = at + standOff(at, std::sqrt(0.5f * twice_area)) * face,
                     .geometric_normal = face,
                     .weight = 1.0f,
                     .reach = reachOf(corners, geometry)}};
}

FacePoints facePoints(const GroupGeometry& geometry, const SampleSet& samples,
                      std::span<const std::uint32_t> triangles) {
  FacePoints points;
  SampleSet& set = points.samples;
  set.origin_offsets.push_back(0);
  const auto append = [&](const SampleStretch& stretch) {
    const std::size_t begin = set.size();
    for (const std::uint32_t t : triangles) {
      const glm::uvec3 corners = geometry.triangles[t];
      const std::uint32_t sample = samples.vertex_sample[corners.x];
      if (sample < stretch.begin || sample >= stretch.end) continue;
      if (!(triangleArea(geometry, corners) > 0.0)) continue;
      const FacePoint point = facePoint(geometry, corners, glm::vec3(1.0f / 3.0f));
      points.triangles.push_back(t);
      set.positions.push_back(point.position);
      set.normals.push_back(point.normal);
      if (glm::dot(point.normal, point.origin.geometric_normal) > 0.0f) set.origins.push_back(point.origin);
      set.origin_offsets.push_back(static_cast<std::uint32_t>(set.origins.size()));
    }
    return SampleStretch{begin, set.size()};
  };
  set.diffuse = append(samples.diffuse);
  set.normal_mapped = append(samples.normal_mapped);
  set.glossy = append(samples.glossy);
  return points;
}

namespace {

// Returns the distance along a Hilbert curve over a 256 x 256 grid.
std::uint32_t hilbertIndex(double u, double v) {
  constexpr std::uint32_t kSide = 256;
  auto x = std::min(static_cast<std::uint32_t>(u * kSide), kSide - 1);
  auto y = std::min(static_cast<std::uint32_t>(v * kSide), kSide - 1);
  std::uint32_t distance = 0;
  for (std::uint32_t s = kSide / 2; s > 0; s /= 2) {
    const std::uint32_t rx = (x & s) ? 1 : 0, ry = (y & s) ? 1 : 0;
    distance += s * s * ((3 * rx) ^ ry);
    if (ry == 0) {
      if (rx == 1) x = kSide - 1 - x, y = kSide - 1 - y;
      std::swap(x, y);
    }
  }
  return distance;
}

// Maps the unit square to the unit disc; it keeps areas, and neighbours stay neighbours.
std::pair<double, double> concentricDisc(double u, double v) {
  const double a = 2.0 * u - 1.0, b = 2.0 * v - 1.0;
  if (a == 0.0 && b == 0.0) return {0.0, 0.0};
  const bool wide = std::abs(a) > std::abs(b);
  const double radius = wide ? a : b;
  const double angle =
      wide ? std::numbers::pi / 4.0 * (b / a) : std::numbers::pi / 2.0 - std::numbers::pi / 4.0 * (a / b);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

// Calls add(x, y) with points of the disc that stand for equal areas, along a Hilbert curve.
template <typename Add>
void forDiscPoints(std::size_t rays, const Add& add) {
  const std::size_t count = std::max<std::size_t>(1, (rays + kPacketWidth - 1) / kPacketWidth) * kPacketWidth;
  struct Point {
    std::uint32_t along;
    double u, v;
  };
  std::vector<Point> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    // The sequence starts at 0.5, because at v = 0 the first ray would lie in the horizon and a flat face
    // would block it.
    const double v = std::fmod(0.5 + static_cast<double>(i) * (std::numbers::phi - 1.0), 1.0);
    points[i] = {hilbertIndex(u, v), u, v};
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const Point& a, const Point& b) { return a.along < b.along; });

  for (const Point& point : points) {
    const auto [x, y] = concentricDisc(point.u, point.v);
    add(x, y);
  }
}

void appendDirection(DirectionTable& table, double x, double y, double z) {
  table.x.push_back(static_cast<float>(x));
  table.y.push_back(static_cast<float>(y));
  table.z.push_back(static_cast<float>(z));
}

}  // namespace

DirectionTable cosineTable(std::size_t rays) {
  DirectionTable table;
  forDiscPoints(rays, [&](double x, double y) {
    appendDirection(table, x, y, std::sqrt(std::max(0.0, 1.0 - x * x - y * y)));
  });
  return table;
}

DirectionTable uniformTable(std::size_t rays) {
  DirectionTable table;
  // This is Lambert's equal-area map from the disc: z = 1 - r².
  forDiscPoints(rays, [&](double x, double y) {
    const double r2 = x * x + y * y, stretch = std::sqrt(std::max(0.0, 2.0 - r2));
    appendDirection(table, stretch * x, stretch * y, std::max(0.0, 1.0 - r2));
  });
  return table;
}

}  // namespace lambent::baker
