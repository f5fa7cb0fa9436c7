#include "runtime/bundle/description.hpp"

#include <algorithm>
#include <utility>

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
