#include <optional>

#include "baker/brdf/surface_brdfs.hpp"

namespace lambent::baker {

Result<BrdfTables> BrdfTables::make(const Scene& scene, int order) {
  using bundle::BrdfFamily;
  BrdfTables out;
  const auto put = [&](BrdfFamily family, std::string name, const Brdf& brdf) {
    out.entries.push_back({family, std::move(name), integrateTable(brdf, order)});
    return static_cast<std::int32_t>(out.entries.size() - 1);
  };
  std::optional<std::int32_t> round, anisotropic;
  std::vector<std::optional<std::int32_t>> measured(scene.brdfs.size());
  for (const gltf::Material& material : scene.materials) {
    std::int32_t& entry = out.of_material.emplace_back(-1);
    if (material.matte()) continue;
    if (material.brdf >= 0) {
      const auto index = static_cast<std::size_t>(material.brdf);
      if (!measured[index]) {
        const auto brdf = makeMeasured(scene.brdfs[index]);
        if (!brdf) return failAgain(brdf.error());
        measured[index] = put(BrdfFamily::Measured, scene.brdfs[index].name, **brdf);
      }
      entry = *measured[index];
    } else if (material.anisotropy > 0.0f) {
      if (!anisotropic) anisotropic = put(BrdfFamily::AnisotropicGgx, "", *makeGgx(true));
      entry = *anisotropic;
    } else {
      if (!round) round = put(BrdfFamily::Ggx, "", *makeGgx(false));
      entry = *round;
    }
  }
  return out;
}

}  // namespace lambent::baker
