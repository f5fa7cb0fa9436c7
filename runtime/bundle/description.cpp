#include "runtime/bundle/description.hpp"

#include <algorithm>

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
