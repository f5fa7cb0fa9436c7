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
  // Vertices at the same place are one.
  std::map<std::tuple<float, float, float>, std::uint32_t> place_of;
  std::vector<std::uint32_t> parent;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t t = level.first_triangle; t < level.first_triangle + level.triangle_count; ++t) {
    if (proxy.triangles[t].front_only) return false;
    std::array<std::uint32_t, 3>& corners = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3& p = proxy.positions[proxy.triangles[t].vertices[k]];
      if (!(glm::dot(p, p) < 1e38f)) return false;  // not finite
      corners[k] =
          place_of.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(parent.size())).first->second;
      if (corners[k] == parent.size()) parent.push_back(corners[k]);
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
      triangles.pop_back();
  }

  // Each edge as often in one direction as in the other.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  const auto rootOf = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& corners : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % 3];
      edges[std::minmax(a, b)] += a < b ? 1 : -1;
      parent[rootOf(a)] = rootOf(b);
    }
  if (std::any_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second != 0; }))
    return false;

  // Every connected part must face outwards: a room seen from outside is dark.
  std::vector<glm::dvec3> places(parent.size());
  for (const auto& [place, index] : place_of)
    places[index] = {std::get<0>(place), std::get<1>(place), std::get<2>(place)};
  std::map<std::uint32_t, double> volumes;
  for (const auto& [a, b, c] : triangles) {
    const glm::dvec3 origin = places[rootOf(a)];
    volumes[rootOf(a)] += glm::dot(places[a] - origin, glm::cross(places[b] - origin, places[c] - origin));
  }
  return !volumes.empty() &&
         std::all_of(volumes.begin(), volumes.end(), [](const auto& v) { return v.second > 0; });
}

}  // namespace lambent::lighting::capture
