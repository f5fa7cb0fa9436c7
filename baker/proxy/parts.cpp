#include "baker/proxy/parts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>

namespace lambent::baker {

float triangleArea(const GroupGeometry& geometry, std::uint32_t triangle) {
  const glm::uvec3 t = geometry.triangles[triangle];
  const glm::vec3 a = geometry.positions[t.x], b = geometry.positions[t.y], c = geometry.positions[t.z];
  return 0.5f * glm::length(glm::cross(b - a, c - a));
}

std::vector<SurfacePoint> pointsOn(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles,
                                   std::size_t count) {
  std::vector<double> sums;
  double sum = 0.0;
  for (const std::uint32_t triangle : triangles)
    sums.push_back(sum += double{triangleArea(geometry, triangle)});
  std::vector<SurfacePoint> points;
  if (!(sum > 0.0) || !std::isfinite(sum)) return points;
  const double step = sum / static_cast<double>(count);
  constexpr double kRoot = 1.32471795724474602596;  // the real root of x³ = x + 1
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (at + 1 < sums.size() && sums[at] <= (static_cast<double>(i) + 0.5) * step) ++at;
    double u = std::fmod(0.5 + static_cast<double>(i) / kRoot, 1.0);
    double v = std::fmod(0.5 + static_cast<double>(i) / (kRoot * kRoot), 1.0);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    points.push_back({triangles[at], static_cast<float>(u), static_cast<float>(v), static_cast<float>(step)});
  }
  return points;
}

namespace {

constexpr std::size_t kCoveragePoints = 256;
constexpr float kLeastCoverage = 0.5f;

std::vector<std::uint32_t> trianglesOf(const DrawGeometry& draw) {
  std::vector<std::uint32_t> triangles(draw.triangle_count);
  std::iota(triangles.begin(), triangles.end(), draw.first_triangle);
  return triangles;
}

bool isSeen(const GroupGeometry& geometry, const SurfaceColors& colors,
            const std::vector<std::uint32_t>& triangles) {
  float sum = 0.0f;
  for (const SurfacePoint& point : pointsOn(geometry, triangles, kCoveragePoints))
    sum += colors.coverage(point.triangle, point.u, point.v);
  return sum >= kLeastCoverage * float{kCoveragePoints};
}

ProxyPart& partFor(std::uint32_t light, bool two_sided, std::vector<ProxyPart>& parts) {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const ProxyPart& part) {
    return part.light == light && part.two_sided == two_sided;
  });
  return found != parts.end() ? *found : parts.emplace_back(ProxyPart{light, two_sided, {}, {}});
}

void append(const std::vector<std::uint32_t>& from, std::vector<std::uint32_t>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

float partArea(const GroupGeometry& geometry, const ProxyPart& part) {
  float sum = 0.0f;
  for (const std::uint32_t triangle : part.front) sum += triangleArea(geometry, triangle);
  return sum;
}

void darkenSmallest(const GroupGeometry& geometry, std::vector<ProxyPart>& parts) {
  std::size_t smallest = parts.size();
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (parts[p].light != kNoLight &&
        (smallest == parts.size() || partArea(geometry, parts[p]) < partArea(geometry, parts[smallest])))
      smallest = p;
  const ProxyPart darkened = std::move(parts[smallest]);
  parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(smallest));
  ProxyPart& dark = partFor(kNoLight, darkened.two_sided, parts);
  append(darkened.front, dark.front);
  append(darkened.back, dark.back);
}

}  // namespace

std::vector<ProxyPart> proxyParts(const GroupGeometry& geometry, const SurfaceColors& colors,
                                  std::size_t most) {
  std::vector<ProxyPart> parts;
  for (std::size_t d = 0; d < geometry.draws.size(); ++d) {
    const DrawGeometry& draw = geometry.draws[d];
    if (draw.back || draw.triangle_count == 0) continue;  // taken with its front
    const std::vector<std::uint32_t> triangles = trianglesOf(draw);
    if (!isSeen(geometry, colors, triangles)) continue;
    const bool two_sided = d + 1 < geometry.draws.size() && geometry.draws[d + 1].back;
    ProxyPart& part = partFor(colors.lightOf(draw.first_triangle), two_sided, parts);
    append(triangles, part.front);
    if (two_sided) append(trianglesOf(geometry.draws[d + 1]), part.back);
  }
  const auto sides = [&] {
    return std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                           [](std::size_t sum, const ProxyPart& part) { return sum + part.sides(); });
  };
  while (sides() > most) darkenSmallest(geometry, parts);
  return parts;
}

}  // namespace lambent::baker
