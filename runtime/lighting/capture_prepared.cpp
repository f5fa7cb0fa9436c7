#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/lighting/capture_plan.hpp"
#include "runtime/lighting/capture_shared.h"

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

namespace {

// Builds the vertices of one level. A triangle's id comes from its last corner, so each triangle needs a
// corner that is last in no other. Closed meshes have half as many vertices as triangles, so about half of
// the triangles need an extra vertex. Black last corners are shared by all triangles that end there.
class LevelVertices {
 public:
  LevelVertices(const bundle::CaptureProxy& proxy, std::vector<Vertex>& vertices)
      : proxy_(proxy),
        vertices_(vertices),
        first_(vertices.size()),
        slots_(proxy.positions.size(), kNone),
        black_(proxy.positions.size(), kNone) {}

  // Rotates `corners` so that few vertices are duplicated, and returns them as vertices of the level.
  std::array<std::uint32_t, 3> add(std::uint32_t surface_id, std::array<std::uint32_t, 3>& corners) {
    for (int turn = 0; turn < 3 && !isFree(corners[2]); ++turn)
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    std::uint32_t last = slots_[corners[2]];
    if (!isFree(corners[2])) {
      last = make(corners[2], 0);
    } else if (last == kNone) {
      last = slots_[corners[2]] = make(corners[2], 0);
    }
    vertices_[first_ + last][3] = surface_id;
    std::array<std::uint32_t, 3> added{0, 0, last};
    for (const std::size_t k : {0u, 1u}) {
      if (slots_[corners[k]] == kNone) slots_[corners[k]] = make(corners[k], 0);
      added[k] = slots_[corners[k]];
    }
    return added;
  }
  std::uint32_t black(std::uint32_t corner) {
    if (black_[corner] == kNone) black_[corner] = make(corner, kBlackId);
    return black_[corner];
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  bool isFree(std::uint32_t corner) const {
    return slots_[corner] == kNone || vertices_[first_ + slots_[corner]][3] == 0;
  }
  std::uint32_t make(std::uint32_t corner, std::uint32_t surface_id) {
    const glm::vec3& p = proxy_.positions[corner];
    vertices_.push_back({std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                         std::bit_cast<std::uint32_t>(p.z), surface_id});
    return static_cast<std::uint32_t>(vertices_.size() - 1 - first_);
  }

  const bundle::CaptureProxy& proxy_;
  std::vector<Vertex>& vertices_;
  std::size_t first_;
  std::vector<std::uint32_t> slots_, black_;  // indexed by position of the proxy
};
// In the worst case each triangle has three corners of its own and a black one.
static_assert(4 * bundle::kMaxProxyTriangles <= 1u << kVertexBits);

glm::dvec4 planeOf(const bundle::CaptureProxy& proxy, const bundle::ProxyTriangle& triangle) {
  const glm::dvec3 a(proxy.positions[triangle.vertices[0]]), b(proxy.positions[triangle.vertices[1]]),
      c(proxy.positions[triangle.vertices[2]]);
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  return {normal, -glm::dot(normal, a)};
}

}  // namespace

PreparedProxy PreparedProxy::of(const bundle::CaptureProxy& proxy) {
  PreparedProxy made{.bounds = ProxyBounds::of(proxy),
                     .levels = {},
                     .vertices = {},
                     .triangle_count = static_cast<std::uint32_t>(proxy.triangles.size())};
  for (const bundle::ProxyLevel& level : proxy.levels) {
    PreparedLevel& drawn = made.levels.emplace_back();
    drawn.first_vertex = static_cast<std::uint32_t>(made.vertices.size());
    drawn.closed = isClosed(proxy, level);
    LevelVertices level_vertices(proxy, made.vertices);
    for (std::uint32_t t = level.first_triangle; t < level.first_triangle + level.triangle_count; ++t) {
      const bundle::ProxyTriangle& triangle = proxy.triangles[t];
      const auto usable = [&](std::uint32_t v) { return isFinite(proxy.positions[v]); };
      if (!std::all_of(triangle.vertices.begin(), triangle.vertices.end(), usable)) continue;
      std::array<std::uint32_t, 3> corners = triangle.vertices;
      LevelTriangle& added = drawn.triangles.emplace_back();
      added.corners = level_vertices.add(t + 1, corners);
      added.front_only = triangle.front_only;
      if (!triangle.front_only) added.black = level_vertices.black(corners[2]);
      added.plane = planeOf(proxy, triangle);
    }
  }
  return made;
}

}  // namespace lambent::lighting::capture
