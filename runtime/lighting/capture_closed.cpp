#include "runtime/lighting/capture_closed.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

namespace lambent::lighting::capture {

bool isClosed(const bundle::CaptureProxy& proxy, const bundle::ProxyLevel& level) {
  struct Corner {
    glm::vec3 place;
    std::uint32_t index;  // three times the triangle, plus the corner
  };
  std::vector<Corner> corners;
  for (std::uint32_t t = level.first_triangle; t < level.first_triangle + level.triangle_count; ++t) {
    if (proxy.triangles[t].front_only) return false;
    for (const std::uint32_t vertex : proxy.triangles[t].vertices) {
      const glm::vec3& p = proxy.positions[vertex];
      if (!(glm::dot(p, p) < 1e38f)) return false;  // not finite
      corners.push_back({p, static_cast<std::uint32_t>(corners.size())});
    }
  }
  // Vertices at the same place are treated as one.
  const auto place = [](const Corner& corner) {
    return std::tuple(corner.place.x, corner.place.y, corner.place.z);
  };
  std::ranges::sort(corners, {}, place);
  std::vector<glm::dvec3> places;
  std::vector<std::array<std::uint32_t, 3>> triangles(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i == 0 || place(corners[i]) != place(corners[i - 1])) places.emplace_back(corners[i].place);
    triangles[corners[i].index / 3][corners[i].index % 3] = static_cast<std::uint32_t>(places.size() - 1);
  }
  std::erase_if(triangles, [](const std::array<std::uint32_t, 3>& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  });

  // Each edge must occur as often in one direction as in the other.
  struct Edge {
    std::uint32_t first, last;
    int direction;
  };
  std::vector<Edge> edges;
  std::vector<std::uint32_t> parent(places.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto rootOf = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
      parent[rootOf(a)] = rootOf(b);
    }
  const auto ends = [](const Edge& edge) { return std::pair(edge.first, edge.last); };
  std::ranges::sort(edges, {}, ends);
  for (std::size_t i = 0, sum = 0; i < edges.size(); ++i) {
    sum += static_cast<std::size_t>(edges[i].direction);  // unsigned wrap-around cancels out
    const bool last = i + 1 == edges.size() || ends(edges[i]) != ends(edges[i + 1]);
    if (last && sum != 0) return false;
  }

  // Every connected part must face outwards: a room seen from outside shows its dark sides.
  std::map<std::uint32_t, double> volumes;
  for (const auto& [a, b, c] : triangles) {
    const glm::dvec3 origin = places[rootOf(a)];
    volumes[rootOf(a)] += glm::dot(places[a] - origin, glm::cross(places[b] - origin, places[c] - origin));
  }
  return !volumes.empty() &&
         std::all_of(volumes.begin(), volumes.end(), [](const auto& v) { return v.second > 0; });
}

}  // namespace lambent::lighting::capture
