// Spreads points evenly over triangles of a group, to take means over its surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

struct SurfacePoint {
  std::uint32_t triangle = 0;
  float u = 0.0f, v = 0.0f;  // barycentric weights of its corners 1 and 2
  float area = 0.0f;         // square metres that the point stands for
};

float triangleArea(const GroupGeometry& geometry, std::uint32_t triangle);

// Returns `count` points of equal area, or none if there is no area. They come in equal steps along the sum
// of areas, and within a triangle by the R2 sequence (Roberts 2018), so they are the same every time.
std::vector<SurfacePoint> pointsOn(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles,
                                   std::size_t count);

}  // namespace lambent::baker
