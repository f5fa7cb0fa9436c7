// Lists the BRDFs: which materials use which, and which materials share a table of b(v). A GGX table serves
// every material of its family, with closed forms on the GPU beside it. Any other BRDF is one function of the
// whole material in red, green and blue: it gets a table of family Measured, with which the runtime shades
// without knowing what it holds. To add one, derive a class from Brdf in a file of its own and add a row to
// the list.
#pragma once

#include <memory>
#include <span>

#include "baker/brdf/brdf.hpp"
#include "baker/import/scene.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

struct BrdfKind {
  const char* name;  // an adjective, shown in plans
  bundle::BrdfFamily family;
  bool (*serves)(const gltf::Material&);  // is asked only of materials that are not matte
  // Returns whether two materials that it serves have one table.
  bool (*share)(const gltf::Material& a, const gltf::Material& b);
  Result<std::unique_ptr<Brdf>> (*make)(const Scene&, const gltf::Material&);
};

std::span<const BrdfKind> brdfKinds();

// Returns the first entry of the list that serves the material, which must not be matte.
const BrdfKind& brdfKindOf(const gltf::Material& material);

}  // namespace lambent::baker
