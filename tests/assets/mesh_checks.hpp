// Checks properties that every generated mesh must have.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "assets/shapes.hpp"

namespace lambent::assets {

inline glm::vec3 faceNormal(const Mesh& mesh, std::size_t triangle) {
  const glm::vec3 a = mesh.positions[mesh.indices[3 * triangle]],
                  b = mesh.positions[mesh.indices[3 * triangle + 1]],
                  c = mesh.positions[mesh.indices[3 * triangle + 2]];
  return glm::cross(b - a, c - a);
}

// Expects finite positions, unit normals, indices in range, no degenerate triangle, and faces oriented as
// their normals.
inline void expectSound(const Mesh& mesh, const std::string& name, float least_cosine = 0.5f) {
  ASSERT_FALSE(mesh.positions.empty()) << name;
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << name;
  ASSERT_TRUE(mesh.texcoords.empty() || mesh.texcoords.size() == mesh.positions.size()) << name;
  ASSERT_EQ(mesh.indices.size() % 3, 0u) << name;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    ASSERT_TRUE(std::isfinite(glm::dot(mesh.positions[i], mesh.positions[i]))) << name << " " << i;
    ASSERT_NEAR(glm::length(mesh.normals[i]), 1.0f, 1e-5f) << name << " " << i;
  }
  for (const std::uint32_t index : mesh.indices) ASSERT_LT(index, mesh.positions.size()) << name;
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const glm::vec3 face = faceNormal(mesh, t);
    ASSERT_GT(glm::length(face), 0.0f) << name << " triangle " << t;
    for (std::size_t corner = 0; corner < 3; ++corner)
      ASSERT_GT(glm::dot(glm::normalize(face), mesh.normals[mesh.indices[3 * t + corner]]), least_cosine)
          << name << " triangle " << t;
  }
}

// Returns whether every edge, identified by the positions of its ends, is used once in each direction.
inline bool isClosed(const Mesh& mesh) {
  using Key = std::array<float, 6>;
  std::map<Key, int> balance;
  const auto point = [&](std::size_t i) {
    return mesh.positions[mesh.indices[i]] + 0.0f;
  };  // + 0.0f turns -0 into 0
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const glm::vec3 a = point(i), b = point(i % 3 == 2 ? i - 2 : i + 1);
    ++balance[{a.x, a.y, a.z, b.x, b.y, b.z}];
    --balance[{b.x, b.y, b.z, a.x, a.y, a.z}];
  }
  for (const auto& [edge, count] : balance)
    if (count != 0) return false;
  return true;
}

// Returns the enclosed volume by the divergence theorem; it is positive if the faces point outwards.
inline double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t)
    sum += double(glm::dot(mesh.positions[mesh.indices[3 * t]], faceNormal(mesh, t))) / 6.0;
  return sum;
}

}  // namespace lambent::assets
