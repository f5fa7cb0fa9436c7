#include <cassert>
#include <cstddef>
#include <optional>

#include "baker/brdf/surface_brdfs.hpp"

namespace lambent::baker {

Result<BrdfTables> BrdfTables::make(const Scene& scene, int order, int shipped) {
  using bundle::BrdfFamily;
  BrdfTables out;
  const auto put = [&](BrdfFamily family, std::string name, const Brdf& brdf) {
    out.entries.push_back({family, std::move(name), integrateTable(brdf, order, gridFor(brdf, shipped))});
    return static_cast<std::int32_t>(out.entries.size() - 1);
  };
  std::optional<std::int32_t> round, anisotropic;
  std::vector<std::optional<std::int32_t>> measured(scene.brdfs.size());
  for (const gltf::Material& material : scene.materials) {
    std::int32_t& entry = out.of_material.emplace_back(-1);
    if (material.matte()) continue;
    const BrdfFamily family = bundle::brdfFamilyOf(material);
    if (family == BrdfFamily::Measured) {
      const auto index = static_cast<std::size_t>(material.brdf);
      if (!measured[index]) {
        const auto brdf = makeMeasured(scene.brdfs[index]);
        if (!brdf) return failAgain(brdf.error());
        measured[index] = put(family, scene.brdfs[index].name, **brdf);
      }
      entry = *measured[index];
      continue;
    }
    const bool is_anisotropic = family == BrdfFamily::AnisotropicGgx;
    std::optional<std::int32_t>& table = is_anisotropic ? anisotropic : round;
    if (!table) table = put(family, "", *makeGgx(is_anisotropic));
    entry = *table;
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
