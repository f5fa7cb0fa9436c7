#include "runtime/bundle/gltf_types.hpp"

#include <cstddef>

namespace lambent::gltf {

glm::mat4 Trs::matrix() const {
  glm::mat4 matrix = glm::mat4_cast(rotation);
  for (int column = 0; column < 3; ++column) matrix[column] *= scale[column];
  matrix[3] = glm::vec4(translation, 1.0f);
  return matrix;
}

std::vector<glm::mat4> worldTransforms(const std::vector<Node>& nodes) {
  std::vector<glm::dmat4> world_from_node(nodes.size(), glm::dmat4(1.0));
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
      world_from_node[i] = glm::dmat4(nodes[i].parent_from_node);
      if (parent >= 0)
        world_from_node[i] = world_from_node[static_cast<std::size_t>(parent)] * world_from_node[i];
    }
  }
  return {world_from_node.begin(), world_from_node.end()};
}

}  // namespace lambent::gltf
