#include "runtime/lighting/capture_prepared.hpp"

#include <algorithm>
#include <bit>

#include <glm/geometric.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/lighting/capture_closed.hpp"
#include "runtime/lighting/capture_shared.h"

namespace lambent::lighting::capture {

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
