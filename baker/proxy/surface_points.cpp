#include "baker/proxy/surface_points.hpp"

#include <cmath>

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

}  // namespace lambent::baker
