#include "editor/gizmo/shapes2d.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lambent::editor {
namespace {

double distanceToSegment(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& pixel) {
  const glm::dvec2 way = b - a;
  const double length2 = glm::dot(way, way);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(pixel - a, way) / length2, 0.0, 1.0) : 0.0;
  return glm::length(pixel - a - t * way);
}

}  // namespace

double distanceToLine(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    nearest = std::min(nearest, distanceToSegment(points[i], points[i + 1], pixel));
  return nearest;
}

double distanceToPolygon(const std::vector<glm::dvec2>& points, const glm::dvec2& pixel) {
  bool inside = false;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, last = points.size() - 1; i < points.size(); last = i++) {
    const glm::dvec2 a = points[i], b = points[last];
    nearest = std::min(nearest, distanceToSegment(a, b, pixel));
    // A pixel is inside if a line to its right crosses an odd number of edges.
    if ((a.y > pixel.y) != (b.y > pixel.y) && pixel.x < a.x + (b.x - a.x) * (pixel.y - a.y) / (b.y - a.y))
      inside = !inside;
  }
  return inside ? 0.0 : nearest;
}

std::vector<glm::dvec2> samplesOf(const std::vector<glm::dvec2>& points, bool filled) {
  std::vector<glm::dvec2> samples;
  if (points.size() < 2) return samples;
  if (filled) {
    glm::dvec2 center(0.0);
    for (const glm::dvec2& point : points) center += point / static_cast<double>(points.size());
    samples.push_back(center);
    for (const glm::dvec2& point : points) samples.push_back(0.5 * (center + point));
    return samples;
  }
  const int parts = std::max<int>(1, 24 / static_cast<int>(points.size() - 1));
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    for (int k = 0; k <= parts; ++k)
      samples.push_back(glm::mix(points[i], points[i + 1], static_cast<double>(k) / parts));
  return samples;
}

Stroke tip(const glm::dvec2& from, const glm::dvec2& to, bool arrow, std::uint32_t color) {
  const glm::dvec2 way = to - from;
  const double length = glm::length(way);
  const glm::dvec2 along = length > 0.0 ? way / length : glm::dvec2(1.0, 0.0), side(-along.y, along.x);
  // Foreshortened axes get smaller tips.
  const double size = std::min(8.0, 0.3 * length);
  Stroke stroke;
  stroke.color = color;
  stroke.filled = stroke.closed = true;
  if (arrow)
    stroke.points = {glm::vec2(to + 1.5 * size * along), glm::vec2(to + 0.6 * size * side),
                     glm::vec2(to - 0.6 * size * side)};
  else
    stroke.points = {glm::vec2(to + 0.6 * size * (along + side)), glm::vec2(to + 0.6 * size * (along - side)),
                     glm::vec2(to - 0.6 * size * (along + side)),
                     glm::vec2(to - 0.6 * size * (along - side))};
  return stroke;
}

Stroke dot(const glm::dvec2& center, double radius, std::uint32_t color) {
  Stroke stroke;
  stroke.color = color;
  stroke.filled = stroke.closed = true;
  for (int i = 0; i < 16; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 16;
    stroke.points.emplace_back(center + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return stroke;
}

}  // namespace lambent::editor
