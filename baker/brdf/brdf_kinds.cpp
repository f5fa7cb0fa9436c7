#include "baker/brdf/brdf_kinds.hpp"

#include <algorithm>
#include <array>

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

}  // namespace lambent::baker
