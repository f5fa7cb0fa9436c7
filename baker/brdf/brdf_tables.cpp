#include <algorithm>
#include <cassert>
#include <cstddef>

#include "baker/brdf/brdf_kinds.hpp"
#include "baker/brdf/surface_brdfs.hpp"

namespace lambent::baker {

Result<BrdfTables> BrdfTables::make(const Scene& scene, int order, int shipped) {
  BrdfTables out;
  std::vector<const gltf::Material*> first_of;  // the first material that uses an entry
  for (const gltf::Material& material : scene.materials) {
    std::int32_t& entry = out.of_material.emplace_back(-1);
    if (material.isDiffuse()) continue;
    const BrdfKind& kind = brdfKindOf(material);
    const auto known = std::ranges::find_if(first_of, [&](const gltf::Material* first) {
      return &brdfKindOf(*first) == &kind && kind.share(*first, material);
    });
    entry = static_cast<std::int32_t>(known - first_of.begin());
    if (known != first_of.end()) continue;
    const auto brdf = kind.make(scene, material);
    if (!brdf) return failAgain(brdf.error());
    first_of.push_back(&material);
    out.entries.push_back(
        {kind.family, material.brdf >= 0 ? scene.brdfs[static_cast<std::size_t>(material.brdf)].name : "",
         integrateTable(**brdf, order, gridFor(**brdf, shipped))});
  }
  return out;
}

bundle::BrdfTable firstBands(const bundle::BrdfTable& table, int order) {
  bundle::BrdfTable out = table;
  out.order = static_cast<std::uint32_t>(order);
  const std::size_t from = table.coefficients(), to = out.coefficients();
  assert(to <= from);
  out.values.clear();
  for (std::size_t first = 0; first < table.values.size(); first += from)
    out.values.insert(out.values.end(), table.values.begin() + static_cast<std::ptrdiff_t>(first),
                      table.values.begin() + static_cast<std::ptrdiff_t>(first + to));
  return out;
}

}  // namespace lambent::baker
