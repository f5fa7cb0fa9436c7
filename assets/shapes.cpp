#include "assets/shapes.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace lambent::assets {

namespace {

int cellsFor(float length, float cell) {
  return std::max(1, static_cast<int>(std::ceil(length / cell - 0.01f)));
}

// The index of vertex (i, j) is j * (cells_u + 1) + i.
void appendCells(Mesh& mesh, int cells_u, int cells_v) {
  const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(j * (cells_u + 1) + i); };
  for (int j = 0; j < cells_v; ++j)
    for (int i = 0; i < cells_u; ++i) {
      const std::uint32_t a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
      for (const auto& [p, q, r] : {std::array{a, b, c}, std::array{a, c, d}}) {
        // Two corners coincide at a pole.
        const glm::vec3 &x = mesh.positions[p], &y = mesh.positions[q], &z = mesh.positions[r];
        if (x == y || y == z || z == x) continue;
        mesh.indices.insert(mesh.indices.end(), {p, q, r});
      }
    }
}

}  // namespace

void append(Mesh& mesh, const Mesh& more, const glm::mat4& place) {
  assert(mesh.positions.empty() || mesh.texcoords.empty() == more.texcoords.empty());
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const glm::mat3 turn = glm::transpose(glm::inverse(glm::mat3(place)));
  for (const glm::vec3 position : more.positions)
    mesh.positions.emplace_back(place * glm::vec4(position, 1.0f));
  for (const glm::vec3 normal : more.normals) mesh.normals.push_back(glm::normalize(turn * normal));
  mesh.texcoords.insert(mesh.texcoords.end(), more.texcoords.begin(), more.texcoords.end());
  for (const std::uint32_t index : more.indices) mesh.indices.push_back(first + index);
}

Mesh withoutTexcoords(Mesh mesh) {
  mesh.texcoords.clear();
  return mesh;
}

Mesh surface(int cells_u, int cells_v, const std::function<SurfacePoint(double u, double v)>& point) {
  Mesh mesh;
  for (int j = 0; j <= cells_v; ++j)
    for (int i = 0; i <= cells_u; ++i) {
      const SurfacePoint at = point(static_cast<double>(i) / cells_u, static_cast<double>(j) / cells_v);
      mesh.positions.push_back(at.position);
      mesh.normals.push_back(at.normal);
    }
  appendCells(mesh, cells_u, cells_v);
  return mesh;
}

Mesh plane(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, int cells_u, int cells_v) {
  const glm::vec3 normal = glm::normalize(glm::cross(edge_u, edge_v));
  Mesh mesh;
  for (int j = 0; j <= cells_v; ++j)
    for (int i = 0; i <= cells_u; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(cells_u);
      const float v = static_cast<float>(j) / static_cast<float>(cells_v);
      mesh.positions.push_back(corner + u * edge_u + v * edge_v);
      mesh.normals.push_back(normal);
      mesh.texcoords.emplace_back(u * glm::length(edge_u), v * glm::length(edge_v));
    }
  appendCells(mesh, cells_u, cells_v);
  return mesh;
}

Mesh plane(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, float cell) {
  return plane(corner, edge_u, edge_v, cellsFor(glm::length(edge_u), cell),
               cellsFor(glm::length(edge_v), cell));
}

Mesh box(glm::vec3 low, glm::vec3 high, float cell) {
  const glm::vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  Mesh mesh;
  append(mesh, plane(low + z, x, y, cell));       // front
  append(mesh, plane(low + x, -x, y, cell));      // back
  append(mesh, plane(low + x + z, -z, y, cell));  // right
  append(mesh, plane(low, z, y, cell));           // left
  append(mesh, plane(low + y + z, x, -z, cell));  // top
  append(mesh, plane(low, x, z, cell));           // bottom
  mesh.texcoords.clear();
  return mesh;
}

Mesh sphere(float radius, int cells) {
  Mesh mesh;
  const glm::vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      const glm::vec3 out = sign * axes[axis], right = axes[(axis + 1) % 3] * sign, up = axes[(axis + 2) % 3];
      append(mesh, surface(cells, cells, [&](double u, double v) {
               // Equal angles instead of equal lengths give cells of nearly one size.
               const auto stretch = [](double t) {
                 return static_cast<float>(std::tan((t - 0.5) * std::numbers::pi / 2));
               };
               const glm::vec3 normal = glm::normalize(out + stretch(u) * right + stretch(v) * up);
               return SurfacePoint{radius * normal, normal};
             }));
    }
  return mesh;
}

Mesh lathe(std::span<const glm::vec2> profile, int segments, float cell) {
  Mesh mesh;
  for (std::size_t piece = 0; piece + 1 < profile.size(); ++piece) {
    const glm::vec2 from = profile[piece], to = profile[piece + 1];
    const glm::vec2 along = glm::normalize(to - from);
    append(mesh, surface(segments, cellsFor(glm::length(to - from), cell), [&](double u, double v) {
             // u runs to the right seen from outside; the last column equals the first exactly.
             const double angle = u < 1.0 ? 2 * std::numbers::pi * u : 0.0;
             const glm::vec3 outward(static_cast<float>(std::sin(angle)), 0,
                                     static_cast<float>(std::cos(angle)));
             const glm::vec2 at = from + static_cast<float>(v) * (to - from);
             return SurfacePoint{at.x * outward + glm::vec3(0, at.y, 0),
                                 along.y * outward - glm::vec3(0, along.x, 0)};
           }));
  }
  return mesh;
}

Mesh torusKnot(const TorusKnot& knot) {
  const double turn = 2 * std::numbers::pi;
  return surface(knot.cells_around, knot.cells_along, [&](double u, double v) {
    const double t = v < 1.0 ? turn * v : 0.0, around = u < 1.0 ? turn * u : 0.0;
    const double ring = knot.p * t, tube = knot.q * t;
    const glm::dvec3 outward(std::sin(ring), 0, std::cos(ring)), up(0, 1, 0);
    const double distance = knot.ring_radius + knot.torus_radius * std::cos(tube);
    const glm::dvec3 centre = distance * outward + knot.torus_radius * std::sin(tube) * up;
    const glm::dvec3 outward_dt = double(knot.p) * glm::dvec3(std::cos(ring), 0, -std::sin(ring));
    const glm::dvec3 tangent =
        glm::normalize(distance * outward_dt +
                       knot.torus_radius * double(knot.q) * (std::cos(tube) * up - std::sin(tube) * outward));
    // The curve lies on the torus, so the normal of the torus is at right angles to it, and the frame closes
    // by itself.
    const glm::dvec3 normal = std::cos(tube) * outward + std::sin(tube) * up;
    const glm::dvec3 side = glm::cross(tangent, normal);
    // The circle runs counter-clockwise about the tangent, so that du x dv points outside.
    const glm::dvec3 radial = std::cos(around) * side + std::sin(around) * glm::cross(tangent, side);
    return SurfacePoint{glm::vec3(centre + double(knot.tube_radius) * radial), glm::vec3(radial)};
  });
}

// This is lowbias32 by C. Wellons.
float hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 0x9e3779b9u ^ (y * 0x85ebca6bu + seed * 0xc2b2ae35u);
  h = (h ^ (h >> 16)) * 0x21f0aaadu;
  h = (h ^ (h >> 15)) * 0x735a2d97u;
  return static_cast<float>((h ^ (h >> 15)) >> 8) / 16777216.0f;
}

float noise(glm::vec2 at, std::uint32_t period, std::uint32_t seed) {
  const glm::vec2 cell = glm::floor(at), t = at - cell;
  const glm::vec2 blend = t * t * (3.0f - 2.0f * t);
  const auto corner = [&](float dx, float dy) {
    return hash(static_cast<std::uint32_t>(cell.x + dx) % period,
                static_cast<std::uint32_t>(cell.y + dy) % period, seed);
  };
  return glm::mix(glm::mix(corner(0, 0), corner(1, 0), blend.x),
                  glm::mix(corner(0, 1), corner(1, 1), blend.x), blend.y);
}

}  // namespace lambent::assets
