// Points spread evenly over triangles of a group, to take means over its surface.
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
  float area = 0.0f;         // square metres that it stands for
};

float triangleArea(const GroupGeometry& geometry, std::uint32_t triangle);

// `count` points of the same area each, none where there is no area: in equal steps along the sum of areas,
// within a triangle by the R2 sequence (Roberts 2018). The same every time.
std::vector<SurfacePoint> pointsOn(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles,
                                   std::size_t count);

}  // namespace lambent::baker
