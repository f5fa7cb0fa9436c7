#include "runtime/bundle/description.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "runtime/base/payload_bytes.hpp"

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

std::vector<std::byte> encodeVoxels(std::span<const std::uint32_t> voxels) {
  std::vector<std::int32_t> steps(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i)
    steps[i] = static_cast<std::int32_t>(voxels[i] - (i > 0 ? voxels[i - 1] : 0u));
  std::vector<std::byte> bytes;
  appendIntegers(bytes, steps);
  return bytes;
}

Result<std::vector<std::uint32_t>> decodeVoxels(std::span<const std::byte> bytes, const glm::uvec3& grid_size,
                                                const std::string& subject) {
  if (bytes.size() % 4 != 0) return fail(subject, "has a list of voxels that ends in one", "bake it again");
  const std::vector<std::int32_t> steps = Front(bytes).integers(bytes.size() / 4);
  const std::int64_t count = std::int64_t{grid_size.x} * grid_size.y * grid_size.z;
  std::vector<std::uint32_t> voxels;
  voxels.reserve(steps.size());
  std::int64_t voxel = 0;
  for (const std::int32_t step : steps) {
    voxel += step;
    if (step < 0 || (step == 0 && !voxels.empty()) || voxel >= count)
      return fail(subject, "has a list of voxels that is not in order", "bake it again");
    voxels.push_back(static_cast<std::uint32_t>(voxel));
  }
  return voxels;
}

}  // namespace lambent::bundle
