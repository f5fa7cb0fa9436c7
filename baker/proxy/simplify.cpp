#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <meshoptimizer.h>

#include "baker/proxy/capture_proxy.hpp"

namespace lambent::baker {

namespace {

// Collapses take time per triangle, so larger surfaces are reduced by clusters of vertices first.
constexpr std::size_t kDetailed = 1u << 18;

using Indices = std::vector<unsigned int>;

// Corners of faces that meet may differ in their last bits after a rotation, so they count as the same if
// they round to the same point of a fine lattice.
using LatticePoint = glm::ivec3;
constexpr float kLattice = 0x1p-18f;  // of the surface's size; the step is up to twice as large

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
  const auto rounded = [&](const glm::vec3& p) { return glm::round(glm::dvec3(p) / step); };
  std::vector<LatticePoint> points;
  points.reserve(3 * triangles.size());
  for (const std::uint32_t triangle : triangles)
    for (int c = 0; c < 3; ++c) points.emplace_back(rounded(corner(triangle, c)) - rounded(low));
  Indices indices(points.size());
  std::vector<glm::vec3> positions(meshopt_generateVertexRemap(
      indices.data(), nullptr, points.size(), points.data(), points.size(), sizeof(LatticePoint)));
  for (std::size_t i = points.size(); i-- > 0;)  // so that the first of equal ones stays
    positions[indices[i]] = corner(triangles[i / 3], static_cast<int>(i % 3));
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

namespace {

constexpr int kSide = 128;  // pixels
constexpr float kEnd = kSide;

float cross2(glm::vec2 a, glm::vec2 b) {
  return a.x * b.y - a.y * b.x;
}

// Marks pixels whose centre the triangle covers, whichever way it winds.
void fill(glm::vec2 a, glm::vec2 b, glm::vec2 c, std::vector<std::uint8_t>& pixels) {
  if (cross2(b - a, c - a) < 0.0f) std::swap(b, c);
  const auto first = [](float v) { return static_cast<int>(std::clamp(std::ceil(v - 0.5f), 0.0f, kEnd)); };
  const int x0 = first(std::min({a.x, b.x, c.x})), x1 = first(std::max({a.x, b.x, c.x}) + 1.0f);
  const int y0 = first(std::min({a.y, b.y, c.y})), y1 = first(std::max({a.y, b.y, c.y}) + 1.0f);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const glm::vec2 p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      if (cross2(b - a, p - a) >= 0.0f && cross2(c - b, p - b) >= 0.0f && cross2(a - c, p - c) >= 0.0f)
        pixels[static_cast<std::size_t>(y * kSide + x)] = 1;
    }
}

}  // namespace

double Silhouette::pixelsOf(std::span<const SimpleMesh> meshes, const View& view) {
  std::vector<std::uint8_t> pixels(std::size_t{kSide} * kSide, 0);
  const glm::vec2 scale = kEnd / (view.high - view.low);
  for (const SimpleMesh& mesh : meshes) {
    std::vector<glm::vec2> flat;
    for (const glm::vec3& p : mesh.positions)
      flat.push_back((glm::vec2(glm::dot(p, view.right), glm::dot(p, view.up)) - view.low) * scale);
    for (const glm::uvec3& t : mesh.triangles) fill(flat[t.x], flat[t.y], flat[t.z], pixels);
  }
  return static_cast<double>(std::count(pixels.begin(), pixels.end(), std::uint8_t{1}));
}

Silhouette::Silhouette(std::span<const SimpleMesh> original) {
  constexpr std::array<glm::vec3, 7> kDirections = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}}};
  for (std::size_t i = 0; i < views_.size(); ++i) {
    View& view = views_[i];
    const glm::vec3 direction = glm::normalize(kDirections[i]);
    const glm::vec3 aside =
        std::abs(direction.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
    view.right = glm::normalize(glm::cross(aside, direction));
    view.up = glm::cross(direction, view.right);
    view.low = glm::vec2(std::numeric_limits<float>::max());
    view.high = -view.low;
    for (const SimpleMesh& mesh : original)
      for (const glm::vec3& p : mesh.positions) {
        const glm::vec2 q(glm::dot(p, view.right), glm::dot(p, view.up));
        view.low = glm::min(view.low, q), view.high = glm::max(view.high, q);
      }
    const glm::vec2 size = view.high - view.low;
    const double pixel = double{size.x} * double{size.y} / (kSide * kSide);
    // A width that floats can hold may have an inverse that they cannot.
    const glm::vec2 scale = kEnd / size;
    if (!(pixel > 0.0) || !std::isfinite(pixel) || !std::isfinite(scale.x + scale.y)) continue;
    view.pixel = pixel;
    view.covered = pixelsOf(original, view);
  }
}

float Silhouette::scaleOf(std::span<const SimpleMesh> proxy) const {
  double wanted = 0.0, found = 0.0;
  for (const View& view : views_) {
    if (view.pixel == 0.0) continue;
    wanted += view.pixel * view.covered;
    found += view.pixel * pixelsOf(proxy, view);
  }
  if (!(wanted > 0.0) || !(found > 0.0)) return 1.0f;
  return std::clamp(static_cast<float>(std::sqrt(wanted / found)), 0.5f, 2.0f);
}

}  // namespace lambent::baker
