// Goes through the triangles of a mesh where a node places them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Calls tell(corners) with each triangle, moved by the matrix. Vertices are moved once, since triangles share
// them.
template <typename Tell>
void eachTriangle(const bundle::MeshData& mesh, const glm::mat4& matrix, const Tell& tell) {
  std::vector<glm::vec3> moved;
  moved.reserve(mesh.positions.size());
  for (const glm::vec3& p : mesh.positions) moved.emplace_back(matrix * glm::vec4(p, 1.0f));
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    tell(std::array{moved[mesh.indices[i]], moved[mesh.indices[i + 1]], moved[mesh.indices[i + 2]]});
}

}  // namespace lambent::baker
