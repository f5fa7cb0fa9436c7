// Divides triangles into connected parts, and tells which of them are closed. Triangles are given by the
// numbers of their corners (corner_numbers.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lambent::baker {

using CornerTriangle = std::array<std::uint32_t, 3>;

// Returns the indices of the triangles of each part. Triangles that share a corner belong together. Corners
// are numbered from 0 to `corners` - 1.
std::vector<std::vector<std::size_t>> connectedParts(std::span<const CornerTriangle> triangles,
                                                     std::size_t corners);

// Returns whether each edge of the part is passed as often in one direction as in the other. Edges without
// length do not count.
bool isClosed(std::span<const CornerTriangle> triangles, std::span<const std::size_t> part);

}  // namespace lambent::baker
