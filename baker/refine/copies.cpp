#include "baker/refine/copies.hpp"

#include <algorithm>

namespace lambent::baker {

CopiesOfMeshes copiesOf(const std::vector<RigidGroup>& groups,
                        const std::vector<std::vector<bundle::MeshData>>& meshes) {
  CopiesOfMeshes copies;
  for (const auto& primitives : meshes) copies.emplace_back(primitives.size(), 0);
  for (const RigidGroup& group : groups)
    for (const PlannedDraw& draw : group.draws)
      if (!draw.back) ++copies[draw.mesh][draw.primitive];
  for (auto& primitives : copies)
    for (std::size_t& count : primitives) count = std::max<std::size_t>(count, 1);
  return copies;
}

std::size_t countDrawn(const CopiesOfMeshes& copies,
                       const std::vector<std::vector<bundle::MeshData>>& meshes) {
  std::size_t count = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t p = 0; p < meshes[m].size(); ++p) count += copies[m][p] * meshes[m][p].positions.size();
  return count;
}

}  // namespace lambent::baker
