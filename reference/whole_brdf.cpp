#include "reference/whole_brdf.hpp"

#include <algorithm>
#include <array>

#include "reference/measured.hpp"

namespace lambent::baker::reference {

namespace {

using gltf::Material;

struct Kind {
  bool (*serves)(const Material&);                     // not called for diffuse materials
  bool (*same)(const Material& a, const Material& b);  // whether two such materials reflect alike
  std::shared_ptr<const WholeBrdf> (*make)(const Scene&, const Material&);
};

// Earlier rows have priority.
constexpr std::array kKinds = {
    Kind{[](const Material& m) { return m.brdf >= 0; },
         [](const Material& a, const Material& b) { return a.brdf == b.brdf; },
         [](const Scene& scene, const Material& m) -> std::shared_ptr<const WholeBrdf> {
           return std::make_shared<MeasuredReflection>(scene.brdfs[static_cast<std::size_t>(m.brdf)]);
         }},
};

}  // namespace

std::vector<std::shared_ptr<const WholeBrdf>> wholeBrdfs(const Scene& scene) {
  struct Made {
    const Kind* kind;
    const Material* material;
    std::shared_ptr<const WholeBrdf> brdf;
  };
  std::vector<Made> all;
  std::vector<std::shared_ptr<const WholeBrdf>> of_material;
  for (const Material& material : scene.materials) {
    auto& own = of_material.emplace_back();
    const auto kind = std::ranges::find_if(kKinds, [&](const Kind& k) { return k.serves(material); });
    if (material.isDiffuse() || kind == kKinds.end()) continue;
    auto known = std::ranges::find_if(
        all, [&](const Made& made) { return made.kind == &*kind && kind->same(*made.material, material); });
    if (known == all.end()) known = all.insert(all.end(), {&*kind, &material, kind->make(scene, material)});
    own = known->brdf;
  }
  return of_material;
}

}  // namespace lambent::baker::reference
