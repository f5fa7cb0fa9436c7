#include "baker/proxy/simplify.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <meshoptimizer.h>

namespace lambent::baker {

namespace {

// Collapses take time per triangle, so larger surfaces are reduced by clusters of vertices first.
constexpr std::size_t kDetailed = 1u << 18;

using Indices = std::vector<unsigned int>;

// Corners of faces that meet may differ in their last bits after a rotation, so they count as the same if
// they round to the same point of a fine lattice.
using LatticePoint = std::array<std::int64_t, 3>;
constexpr float kLattice = 0x1p-18f;  // of the surface's size; the step is up to twice as large

struct LatticeHash {
  std::size_t operator()(const LatticePoint& point) const {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const std::int64_t n : point)
      hash = (hash ^ static_cast<std::uint64_t>(n)) * 0xD6E8FEB86659FD93u, hash ^= hash >> 32;
    return hash;
  }
};

// Drops triangles without area and vertices without a triangle.
SimpleMesh compacted(const std::vector<glm::vec3>& positions, const Indices& indices, float error_m) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  SimpleMesh mesh;
  mesh.error_m = error_m;
  std::vector<std::uint32_t> place(positions.size(), kNone);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const glm::vec3 a = positions[indices[i]], b = positions[indices[i + 1]], c = positions[indices[i + 2]];
    if (!(glm::length(glm::cross(b - a, c - a)) > 0.0f)) continue;
    glm::uvec3 triangle;
    for (int corner = 0; corner < 3; ++corner) {
      std::uint32_t& at = place[indices[i + static_cast<std::size_t>(corner)]];
      if (at == kNone) {
        at = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(positions[indices[i + static_cast<std::size_t>(corner)]]);
      }
      triangle[corner] = at;
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

Indices indicesOf(const SimpleMesh& mesh) {
  Indices indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
  return indices;
}

constexpr float kAnyError = 1e6f;  // in sizes of the surface

enum class Method : std::uint8_t { Collapses, Clusters };

SimpleMesh reduced(const SimpleMesh& mesh, std::size_t most, Method method, float allowed = kAnyError) {
  const Indices indices = indicesOf(mesh);
  Indices out(indices.size());
  float error = 0.0f;
  const float* first = &mesh.positions.front().x;
  const std::size_t count =
      method == Method::Collapses
          ? meshopt_simplify(out.data(), indices.data(), indices.size(), first, mesh.positions.size(),
                             sizeof(glm::vec3), 3 * most, allowed, 0, &error)
          : meshopt_simplifySloppy(out.data(), indices.data(), indices.size(), first, mesh.positions.size(),
                                   sizeof(glm::vec3), 3 * most, allowed, &error);
  out.resize(count);
  const float scale = meshopt_simplifyScale(first, mesh.positions.size(), sizeof(glm::vec3));
  return compacted(mesh.positions, out, mesh.error_m + error * scale);
}

// Returns the box around the mesh, or a tetrahedron in it if a box has too many triangles; both are closed.
SimpleMesh boxed(const SimpleMesh& mesh, std::size_t most) {
  glm::vec3 low = mesh.positions.front(), high = low;
  for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
  std::vector<glm::vec3> corners;
  for (unsigned i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  const Indices box = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                       2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  const Indices tetrahedron = {0, 6, 3, 0, 5, 6, 0, 3, 5, 3, 6, 5};
  return compacted(corners, most >= 12 ? box : tetrahedron, mesh.error_m + glm::distance(low, high));
}

}  // namespace

SimpleMesh welded(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles) {
  const auto corner = [&](std::uint32_t triangle, int c) {
    return geometry.positions[geometry.triangles[triangle][c]];
  };
  if (triangles.empty()) return {};
  glm::vec3 low = corner(triangles[0], 0), high = low;
  for (const std::uint32_t triangle : triangles)
    for (int c = 0; c < 3; ++c)
      low = glm::min(low, corner(triangle, c)), high = glm::max(high, corner(triangle, c));
  const glm::vec3 size = high - low;
  // The step is a power of two, so that points on the lattice that ships lie on this one too.
  const double step = std::exp2(
      std::ceil(std::log2(std::max(double{kLattice} * double{std::max({size.x, size.y, size.z})}, 1e-30))));
  std::unordered_map<LatticePoint, unsigned int, LatticeHash> seen;
  std::vector<glm::vec3> positions;
  Indices indices;
  indices.reserve(3 * triangles.size());
  for (const std::uint32_t triangle : triangles)
    for (int c = 0; c < 3; ++c) {
      const glm::vec3 p = corner(triangle, c);
      const glm::dvec3 n = glm::round(glm::dvec3(p) / step);
      const LatticePoint point = {std::llround(n.x), std::llround(n.y), std::llround(n.z)};
      const auto [entry, is_new] = seen.try_emplace(point, static_cast<unsigned int>(positions.size()));
      if (is_new) positions.push_back(p);
      indices.push_back(entry->second);
    }
  return compacted(positions, indices, 0.0f);
}

SimpleMesh simplified(const SimpleMesh& mesh, std::size_t most, float allowed_m) {
  if (mesh.triangles.size() <= most && allowed_m == 0.0f) return mesh;
  SimpleMesh start = mesh;
  if (start.triangles.size() > kDetailed) {
    SimpleMesh clusters = reduced(mesh, kDetailed, Method::Clusters);
    if (clusters.triangles.size() > most) start = std::move(clusters);
  }
  if (allowed_m > 0.0f) {
    const float size =
        meshopt_simplifyScale(&mesh.positions.front().x, mesh.positions.size(), sizeof(glm::vec3));
    SimpleMesh within = reduced(start, 1, Method::Collapses, allowed_m / size);
    if (!within.triangles.empty() && within.triangles.size() <= most) return within;
    if (mesh.triangles.size() <= most) return mesh;
  }
  SimpleMesh best = reduced(start, most, Method::Collapses);
  if (best.triangles.size() > most) best = reduced(best, most, Method::Clusters);
  if (best.triangles.empty() || best.triangles.size() > most) best = boxed(mesh, most);
  return best;
}

}  // namespace lambent::baker
