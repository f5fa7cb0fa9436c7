#include "runtime/bundle/description.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "runtime/bundle/gltf_types.hpp"

namespace lambent::bundle {

void countFrom(const glm::dvec3& origin, Description& description) {
  const glm::vec3 shift(description.origin - origin);
  if (shift == glm::vec3(0.0f)) return;
  if (description.origin == glm::dvec3(0.0)) {  // animations may move the roots, so they get one above them
    const auto root = static_cast<std::int32_t>(description.nodes.size());
    for (gltf::Node& node : description.nodes)
      if (node.parent < 0) node.parent = root;
    gltf::Node& added = description.nodes.emplace_back();
    added.children = std::exchange(description.roots, {root});
  }
  for (gltf::Node& node : description.nodes)
    if (node.parent < 0) node.parent_from_node[3] += glm::vec4(shift, 0.0f);
  for (Group& group : description.groups) group.rest_translation += shift;
  description.origin = origin;
}

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
