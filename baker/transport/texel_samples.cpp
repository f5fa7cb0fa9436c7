#include "baker/transport/texel_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/transport/samples.hpp"

namespace lambent::baker {

namespace {

// A bilinear filter reads the centres around a point, which lie less than so many texels away from it.
constexpr double kReach = 1.41421356;
// Samples on the border stand so many texels inside, so that they see no more than the surface does.
constexpr double kInside = 0.1;

using Corners = std::array<glm::dvec2, 3>;

double crossOf(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

Corners cornersOf(const GroupGeometry& geometry, std::uint32_t triangle, std::uint32_t side) {
  Corners corners;
  for (int c = 0; c < 3; ++c)
    corners[static_cast<std::size_t>(c)] =
        glm::dvec2(geometry.chart_coordinates[geometry.triangles[triangle][c]]) * static_cast<double>(side);
  return corners;
}

glm::dvec2 nearestOnEdge(const glm::dvec2& at, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = b - a;
  const double length = glm::dot(along, along);
  return length > 0.0 ? a + std::clamp(glm::dot(at - a, along) / length, 0.0, 1.0) * along : a;
}

glm::dvec3 sharesOf(const glm::dvec2& at, const Corners& corners) {
  const double area = crossOf(corners[1] - corners[0], corners[2] - corners[0]);
  const double b = crossOf(at - corners[0], corners[2] - corners[0]) / area,
               c = crossOf(corners[1] - corners[0], at - corners[0]) / area;
  return {1.0 - b - c, b, c};
}

// Returns the nearest point of a triangle, and how far away it is.
std::pair<glm::dvec2, double> nearestIn(const glm::dvec2& at, const Corners& corners) {
  const glm::dvec3 shares = sharesOf(at, corners);
  if (shares.x >= 0.0 && shares.y >= 0.0 && shares.z >= 0.0) return {at, 0.0};
  std::pair<glm::dvec2, double> best{corners[0], glm::distance(at, corners[0])};
  for (std::size_t c = 0; c < 3; ++c)
    if (const glm::dvec2 near = nearestOnEdge(at, corners[c], corners[(c + 1) % 3]);
        glm::distance(at, near) < best.second)
      best = {near, glm::distance(at, near)};
  return best;
}

// Moves a point on the border of a triangle inwards.
glm::dvec3 movedInside(glm::dvec2 at, const Corners& corners) {
  const glm::dvec2 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
  const double way = glm::distance(at, middle);
  if (way > 0.0) at += std::min(kInside / way, 1.0 / 3.0) * (middle - at);
  return sharesOf(at, corners);
}

glm::vec2 placeOf(const GroupGeometry& geometry, std::uint32_t side, const glm::uvec3& corners,
                  const glm::vec3& shares) {
  const auto& at = geometry.chart_coordinates;
  return static_cast<float>(side) *
         (shares.x * at[corners.x] + shares.y * at[corners.y] + shares.z * at[corners.z]);
}

std::uint32_t texelAt(float x, float y, std::uint32_t side) {
  const auto clamped = [&](float at) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(at), 0.0f, static_cast<float>(side - 1)));
  };
  return clamped(x) + side * clamped(y);
}

}  // namespace

std::vector<TexelPoint> texelPoints(const GroupGeometry& geometry, const DrawGeometry& draw) {
  const std::uint32_t side = draw.texels;
  const std::size_t count = std::size_t{side} * side;
  std::vector<TexelPoint> points(count);
  std::vector<double> distance(count, kReach);
  for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
    const Corners corners = cornersOf(geometry, t, side);
    const double area = std::abs(crossOf(corners[1] - corners[0], corners[2] - corners[0])) * 0.5;
    if (!(area > 0.0)) continue;  // coding has flattened it
    const auto size_m = static_cast<float>(std::sqrt(triangleArea(geometry, geometry.triangles[t]) / area));
    const glm::dvec2 low = glm::min(corners[0], glm::min(corners[1], corners[2])) - kReach,
                     high = glm::max(corners[0], glm::max(corners[1], corners[2])) + kReach;
    const auto clamped = [&](double at) {
      return static_cast<std::uint32_t>(std::clamp(at, 0.0, static_cast<double>(side)));
    };
    for (std::uint32_t y = clamped(low.y); y < clamped(std::ceil(high.y)); ++y)
      for (std::uint32_t x = clamped(low.x); x < clamped(std::ceil(high.x)); ++x) {
        const glm::dvec2 centre(x + 0.5, y + 0.5);
        const auto [near, away] = nearestIn(centre, corners);
        const std::size_t texel = x + std::size_t{side} * y;
        if (!(away < distance[texel])) continue;
        distance[texel] = away;
        const glm::dvec3 shares = away > 0.0 ? movedInside(near, corners) : sharesOf(near, corners);
        points[texel] = {static_cast<std::uint32_t>(texel), t, glm::vec3(shares), size_m};
      }
  }
  std::erase_if(points, [](const TexelPoint& point) { return point.size_m == 0.0f; });
  return points;
}

std::vector<std::uint32_t> dilated(const TexelMap& map) {
  std::vector<std::uint32_t> shown = map.sample_of;
  std::vector<std::uint32_t> front;
  for (std::uint32_t texel = 0; texel < shown.size(); ++texel)
    if (shown[texel] != kNoSample) front.push_back(texel);
  // Each ring takes from the one before; within a ring the order of texels decides.
  while (!front.empty()) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t from : front)
      for (int step = 0; step < 4; ++step) {
        constexpr std::array<int, 4> kX = {1, -1, 0, 0}, kY = {0, 0, 1, -1};
        const auto i = static_cast<std::size_t>(step);
        const int x = static_cast<int>(from % map.side) + kX[i],
                  y = static_cast<int>(from / map.side) + kY[i];
        const int side = static_cast<int>(map.side);
        if (x < 0 || y < 0 || x >= side || y >= side) continue;
        const auto texel = static_cast<std::uint32_t>(x + side * y);
        if (shown[texel] != kNoSample) continue;
        shown[texel] = shown[from];
        next.push_back(texel);
      }
    front = std::move(next);
  }
  return shown;
}

std::uint32_t sampleOfTexel(const GroupGeometry& geometry, const TexelMap& map, std::uint32_t triangle,
                            const glm::vec3& shares) {
  const glm::vec2 at = placeOf(geometry, map.side, geometry.triangles[triangle], shares);
  return map.sample_of[texelAt(at.x, at.y, map.side)];
}

std::array<SampleShare, 4> shownSamples(const GroupGeometry& geometry, const SampleSet& samples,
                                        std::uint32_t triangle, const glm::vec3& shares) {
  const glm::uvec3 corners = geometry.triangles[triangle];
  for (const TexelMap& map : samples.texels) {
    if (triangle < map.first_triangle || triangle >= map.first_triangle + map.triangle_count) continue;
    const glm::vec2 at = placeOf(geometry, map.side, corners, shares) - 0.5f;
    const glm::vec2 part = at - glm::floor(at);
    std::array<SampleShare, 4> shown;
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const bool right = i % 2 == 1, above = i / 2 == 1;
      const std::uint32_t sample = map.sample_of[texelAt(std::floor(at.x) + (right ? 1.0f : 0.0f),
                                                         std::floor(at.y) + (above ? 1.0f : 0.0f), map.side)];
      const float share = (right ? part.x : 1.0f - part.x) * (above ? part.y : 1.0f - part.y);
      if (sample == kNoSample) continue;
      shown[i] = {sample, share};
      sum += share;
    }
    for (SampleShare& entry : shown) entry.share /= sum;
    if (sum > 0.0f) return shown;
  }
  std::array<SampleShare, 4> shown;
  for (int c = 0; c < 3; ++c)
    shown[static_cast<std::size_t>(c)] = {samples.vertex_sample[corners[c]], shares[c]};
  shown[3] = {shown[0].sample, 0.0f};
  return shown;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> texelEdges(const GroupGeometry& geometry,
                                                                const TexelMap& map) {
  // The triangles of a chart share vertices.
  std::vector<std::uint32_t> parent(geometry.positions.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto chartOf = [&](std::uint32_t vertex) {
    while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  for (std::uint32_t t = map.first_triangle; t < map.first_triangle + map.triangle_count; ++t)
    for (int c = 1; c < 3; ++c) parent[chartOf(geometry.triangles[t][c])] = chartOf(geometry.triangles[t].x);
  const auto chartOfTexel = [&](std::size_t texel) {
    return chartOf(geometry.triangles[map.triangle_of[texel]].x);
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  const auto join = [&](std::size_t a, std::size_t b) {
    const std::uint32_t from = map.sample_of[a], to = map.sample_of[b];
    if (from != kNoSample && to != kNoSample && chartOfTexel(a) == chartOfTexel(b))
      edges.emplace_back(std::min(from, to), std::max(from, to));
  };
  for (std::size_t y = 0; y < map.side; ++y)
    for (std::size_t x = 0; x < map.side; ++x) {
      const std::size_t texel = x + map.side * y;
      if (x + 1 < map.side) join(texel, texel + 1);
      if (y + 1 < map.side) join(texel, texel + map.side);
    }
  return edges;
}

}  // namespace lambent::baker
