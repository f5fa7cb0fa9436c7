#include "baker/import/connected_parts.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace lambent::baker {

std::vector<std::vector<std::size_t>> connectedParts(std::span<const CornerTriangle> triangles,
                                                     std::size_t corners) {
  std::vector<std::uint32_t> parent(corners);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto rootOf = [&](std::uint32_t corner) {
    while (parent[corner] != corner) corner = parent[corner] = parent[parent[corner]];
    return corner;
  };
  for (const CornerTriangle& triangle : triangles)
    for (const std::uint32_t corner : triangle) parent[rootOf(corner)] = rootOf(triangle[0]);
  std::map<std::uint32_t, std::vector<std::size_t>> parts;  // by root
  for (std::size_t t = 0; t < triangles.size(); ++t) parts[rootOf(triangles[t][0])].push_back(t);
  std::vector<std::vector<std::size_t>> list;
  for (auto& [root, part] : parts) list.push_back(std::move(part));
  return list;
}

bool isClosed(std::span<const CornerTriangle> triangles, std::span<const std::size_t> part) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<std::pair<Edge, int>> edges;  // the lower corner first, and which way it is passed
  for (const std::size_t t : part)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (a != b) edges.push_back({std::minmax(a, b), a < b ? 1 : -1});
    }
  std::ranges::sort(edges);
  for (std::size_t i = 0; i < edges.size();) {
    int balance = 0;
    const Edge edge = edges[i].first;
    for (; i < edges.size() && edges[i].first == edge; ++i) balance += edges[i].second;
    if (balance != 0) return false;
  }
  return true;
}

}  // namespace lambent::baker
