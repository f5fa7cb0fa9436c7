#include "baker/transport/direction_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace lambent::baker {

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
