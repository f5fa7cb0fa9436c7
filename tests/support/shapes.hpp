// Makes small meshes and scenes with known answers. Triangles wind counter-clockwise seen from outside.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "baker/import/scene.hpp"

namespace lambent::testing {

// Makes a square in the xz plane around `centre`, with normal +Y, of n x n cells.
inline bundle::MeshData grid(glm::vec3 centre, float width, int n) {
  bundle::MeshData mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(n) - 0.5f;
      const float v = static_cast<float>(j) / static_cast<float>(n) - 0.5f;
      mesh.positions.push_back(centre + width * glm::vec3(u, 0.0f, v));
      mesh.normals.emplace_back(0.0f, 1.0f, 0.0f);
      mesh.texcoords0.emplace_back(u + 0.5f, v + 0.5f);
    }
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (const std::uint32_t index :
           {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)})
        mesh.indices.push_back(index);
  return mesh;
}

// Transforms a mesh by a `matrix` without shear; normals are only rotated.
inline bundle::MeshData transformed(bundle::MeshData mesh, const glm::mat4& matrix) {
  for (glm::vec3& p : mesh.positions) p = glm::vec3(matrix * glm::vec4(p, 1.0f));
  for (glm::vec3& n : mesh.normals) n = glm::normalize(glm::mat3(matrix) * n);
  return mesh;
}

inline bundle::MeshData turned(bundle::MeshData mesh, float degrees, glm::vec3 axis) {
  return transformed(std::move(mesh), glm::rotate(glm::mat4(1.0f), glm::radians(degrees), axis));
}

inline bundle::MeshData joined(bundle::MeshData a, const bundle::MeshData& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  a.texcoords0.clear();
  for (const std::uint32_t index : b.indices) a.indices.push_back(first + index);
  return a;
}

inline bundle::MeshData flipped(bundle::MeshData mesh) {
  for (glm::vec3& n : mesh.normals) n = -n;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  return mesh;
}

// Makes a box of six grids with flat normals that point outwards.
inline bundle::MeshData box(glm::vec3 centre, glm::vec3 size, int n) {
  bundle::MeshData mesh;
  const bundle::MeshData top = grid({0.0f, 0.5f, 0.0f}, 1.0f, n);
  for (const float angle : {0.0f, 90.0f, 180.0f, 270.0f})
    mesh = joined(std::move(mesh), turned(top, angle, {1, 0, 0}));
  for (const float angle : {90.0f, 270.0f}) mesh = joined(std::move(mesh), turned(top, angle, {0, 0, 1}));
  for (glm::vec3& p : mesh.positions) p = centre + p * size;
  return mesh;
}

inline bundle::MeshData icosphere(glm::vec3 centre, float radius, int subdivisions) {
  const float t = 0.5f * (1.0f + std::sqrt(5.0f));
  std::vector<glm::vec3> points = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                                   {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  std::vector<std::uint32_t> faces = {0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                                      4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                                      6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (is_new) points.push_back(glm::normalize(points[a]) + glm::normalize(points[b]));
      return entry->second;
    };
    std::vector<std::uint32_t> finer;
    for (std::size_t i = 0; i < faces.size(); i += 3) {
      const std::uint32_t a = faces[i], b = faces[i + 1], c = faces[i + 2];
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const std::uint32_t index : {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca}) finer.push_back(index);
    }
    faces = std::move(finer);
  }
  bundle::MeshData mesh;
  for (const glm::vec3& point : points) {
    mesh.normals.push_back(glm::normalize(point));
    mesh.positions.push_back(centre + radius * glm::normalize(point));
  }
  mesh.indices = std::move(faces);
  return mesh;
}

// Makes 300 random intersecting triangles. Normals are those of the faces, tilted randomly by up to `tilt`.
inline bundle::MeshData soup(unsigned seed, float size, float tilt) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  const auto point = [&] { return glm::vec3(uniform(random), uniform(random), uniform(random)); };
  bundle::MeshData mesh;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const glm::vec3 a = point(), b = a + size * point(), c = a + size * point();
    const glm::vec3 face = glm::normalize(glm::cross(b - a, c - a));
    for (const glm::vec3& p : {a, b, c}) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(p);
      mesh.normals.push_back(tilt > 0.0f ? glm::normalize(face + tilt * point()) : face);
    }
  }
  return mesh;
}

// Adds a node without parent, and returns it.
inline gltf::Node& addNode(baker::Scene& scene, const glm::mat4& parent_from_node = glm::mat4(1.0f)) {
  scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
  scene.nodes.push_back({});
  scene.nodes.back().parent_from_node = parent_from_node;
  return scene.nodes.back();
}

// Makes a scene with one static node per mesh, all with one white material.
inline baker::Scene sceneOf(const std::vector<bundle::MeshData>& meshes) {
  baker::Scene scene;
  scene.source = "test.glb";
  gltf::Material white;
  white.name = "white";
  white.metallic = 0.0f;
  scene.materials = {white};
  for (const bundle::MeshData& mesh : meshes) {
    addNode(scene).mesh = static_cast<std::int32_t>(scene.meshes.size());
    scene.meshes.push_back({"", {{mesh, 0}}});
  }
  return scene;
}

// Gives a mesh a material of its own, the last of the scene: a copy of the first, which may be changed.
inline gltf::Material& ownMaterial(baker::Scene& scene, std::size_t mesh) {
  scene.meshes[mesh].primitives[0].material = static_cast<std::int32_t>(scene.materials.size());
  scene.materials.push_back(scene.materials[0]);
  return scene.materials.back();
}

// Adds a light with a node of its own.
inline void addLight(baker::Scene& scene, const gltf::Light& light, const glm::mat4& place) {
  addNode(scene, place).light = static_cast<std::int32_t>(scene.lights.size());
  scene.lights.push_back(light);
}
inline void addPointLight(baker::Scene& scene, const glm::vec3& place) {
  addLight(scene, {}, glm::translate(glm::mat4(1.0f), place));
}

// Returns the inside of a box without its top.
inline bundle::MeshData cup(glm::vec3 size, int n) {
  bundle::MeshData mesh = flipped(box({0, 0, 0}, size, n));
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    if (mesh.normals[mesh.indices[i]].y > -0.5f)
      for (std::size_t c = 0; c < 3; ++c) kept.push_back(mesh.indices[i + c]);
  mesh.indices = kept;
  return mesh;
}

// A Cavity is the inside of a unit sphere with a round opening of half angle `alpha` about `axis`. Its
// `opening` is the fraction of the mesh's sphere area that is open.
struct Cavity {
  bundle::MeshData mesh;
  float opening = 0.0f;
};
inline Cavity cavity(glm::vec3 axis, float alpha_deg) {
  Cavity cavity{flipped(icosphere({0, 0, 0}, 1.0f, 4)), 0.0f};
  std::vector<std::uint32_t> kept;
  float removed = 0.0f, all = 0.0f;
  for (std::size_t i = 0; i < cavity.mesh.indices.size(); i += 3) {
    const std::uint32_t* corners = &cavity.mesh.indices[i];
    const glm::vec3 a = cavity.mesh.positions[corners[0]], b = cavity.mesh.positions[corners[1]],
                    c = cavity.mesh.positions[corners[2]];
    const float area = glm::length(glm::cross(b - a, c - a));
    all += area;
    if (glm::dot(glm::normalize(a + b + c), axis) > std::cos(glm::radians(alpha_deg)))
      removed += area;
    else
      kept.insert(kept.end(), corners, corners + 3);
  }
  cavity.mesh.indices = kept;
  cavity.opening = removed / all;
  return cavity;
}

// Makes a ring about the z axis, of radius 1, from z = 0 to z = height. Its material must have two sides.
inline bundle::MeshData ring(float height, int around) {
  bundle::MeshData mesh;
  for (int i = 0; i < around; ++i)
    for (int top = 0; top < 2; ++top) {
      const float angle =
          2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(around);
      mesh.positions.emplace_back(std::cos(angle), std::sin(angle), top ? height : 0.0f);
      mesh.normals.emplace_back(std::cos(angle), std::sin(angle), 0.0f);
    }
  const auto at = [around](int i, int top) { return static_cast<std::uint32_t>(2 * (i % around) + top); };
  for (int i = 0; i < around; ++i)
    for (const std::uint32_t index : {at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 0), at(i + 1, 1), at(i, 1)})
      mesh.indices.push_back(index);
  return mesh;
}

// Returns Lambert's form factor of a polygon as seen from `p` with normal `n`, above whose horizon it lies:
// the sum over edges of the angle times the edge plane's normal (1760).
inline double formFactor(const std::vector<glm::dvec3>& corners, const glm::dvec3& p, const glm::dvec3& n) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - p),
                     b = glm::normalize(corners[(i + 1) % corners.size()] - p);
    const glm::dvec3 across = glm::cross(a, b);
    sum += std::atan2(glm::length(across), glm::dot(a, b)) * glm::dot(glm::normalize(across), n);
  }
  return std::abs(sum) / (2.0 * std::numbers::pi);
}

}  // namespace lambent::testing
