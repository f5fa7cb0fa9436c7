#include "baker/brdf/brdf_kinds.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

#include "baker/brdf/surface_brdfs.hpp"

namespace lambent::baker {

namespace {

using bundle::BrdfFamily;
using gltf::Material;

bool always(const Material&, const Material&) {
  return true;
}

// The first row that serves a material is used; the last one serves all that are left.
constexpr std::array kKinds = {
    BrdfKind{"measured", BrdfFamily::Measured, [](const Material& m) { return m.brdf >= 0; },
             [](const Material& a, const Material& b) { return a.brdf == b.brdf; },
             [](const Scene& scene, const Material& m) {
               return makeMeasured(scene.brdfs[static_cast<std::size_t>(m.brdf)]);
             }},
    BrdfKind{"anisotropic", BrdfFamily::AnisotropicGgx, [](const Material& m) { return m.anisotropy > 0.0f; },
             &always,
             [](const Scene&, const Material&) -> Result<std::unique_ptr<Brdf>> { return makeGgx(true); }},
    BrdfKind{"round", BrdfFamily::Ggx, [](const Material&) { return true; }, &always,
             [](const Scene&, const Material&) -> Result<std::unique_ptr<Brdf>> { return makeGgx(false); }},
};

}  // namespace

std::span<const BrdfKind> brdfKinds() {
  return kKinds;
}

const BrdfKind& brdfKindOf(const Material& material) {
  return *std::ranges::find_if(kKinds, [&](const BrdfKind& kind) { return kind.serves(material); });
}

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
