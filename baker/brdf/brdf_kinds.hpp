// The list of BRDFs: which materials reflect by which, and which of them share a table of b(v). GGX has
// tables that serve every material of their family, with closed forms on the GPU beside them. Any other BRDF
// is one function of the whole material, red, green and blue: it gets a table of family Measured, by which
// the runtime shades without knowing what it holds. A lobe that is added is a class of kind Brdf in a file of
// its own and a row of the list.
#pragma once

#include <memory>
#include <span>

#include "baker/brdf/brdf.hpp"
#include "baker/import/scene.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

struct BrdfKind {
  const char* name;  // an adjective, for plans
  bundle::BrdfFamily family;
  bool (*serves)(const gltf::Material&);  // asked of materials that are not matte
  bool (*share)(const gltf::Material& a,
                const gltf::Material& b);  // whether two that it serves have one table
  Result<std::unique_ptr<Brdf>> (*make)(const Scene&, const gltf::Material&);
};

std::span<const BrdfKind> brdfKinds();

// The first of the list that serves a material that is not matte.
const BrdfKind& brdfKindOf(const gltf::Material& material);

}  // namespace lambent::baker
