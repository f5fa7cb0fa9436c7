#include "runtime/bundle/description.hpp"

#include <algorithm>
#include <cstddef>

#include "runtime/bundle/gltf_types.hpp"

namespace lambent::bundle {

bool isLayered(const Description& description, const Draw& draw) {
  const std::int32_t index = description.meshes[draw.mesh].primitives[draw.primitive].material;
  if (draw.glossy() || index < 0) return false;
  const gltf::Material& material = description.materials[static_cast<std::size_t>(index)];
  return !material.isDiffuse() && brdfFamilyOf(material) != BrdfFamily::Measured &&
         std::ranges::any_of(description.brdf_tables, [](const BrdfTableEntry& table) {
           return table.family != BrdfFamily::Measured;
         });
}

}  // namespace lambent::bundle

namespace lambent::gltf {

glm::mat4 Trs::matrix() const {
  glm::mat4 matrix = glm::mat4_cast(rotation);
  for (int column = 0; column < 3; ++column) matrix[column] *= scale[column];
  matrix[3] = glm::vec4(translation, 1.0f);
  return matrix;
}

std::vector<glm::mat4> worldTransforms(const std::vector<Node>& nodes) {
  std::vector<glm::mat4> world_from_node(nodes.size(), glm::mat4(1.0f));
  std::vector<bool> done(nodes.size(), false);
  std::vector<std::size_t> chain;
  for (std::size_t start = 0; start < nodes.size(); ++start) {
    // The loop climbs to the first ancestor that is done and comes back down. It does not recurse, because
    // hierarchies may be deep.
    chain.clear();
    for (std::int32_t i = static_cast<std::int32_t>(start); i >= 0 && !done[static_cast<std::size_t>(i)];
         i = nodes[static_cast<std::size_t>(i)].parent) {
      chain.push_back(static_cast<std::size_t>(i));
      done[static_cast<std::size_t>(i)] = true;
    }
    while (!chain.empty()) {
      const std::size_t i = chain.back();
      chain.pop_back();
      const std::int32_t parent = nodes[i].parent;
      world_from_node[i] =
          parent < 0 ? nodes[i].parent_from_node
                     : world_from_node[static_cast<std::size_t>(parent)] * nodes[i].parent_from_node;
    }
  }
  return world_from_node;
}

}  // namespace lambent::gltf
