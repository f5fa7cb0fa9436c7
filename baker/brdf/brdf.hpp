// Defines the interface of all BRDFs: values of f for given directions in the local frame (z the normal, x
// the tangent), split into lobes as runtime/bundle/brdf_table.hpp has them. It knows no scene, textures or
// rays. brdfKinds() lists the BRDFs.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/gltf_types.hpp"

namespace lambent::baker {

struct MeasuredBrdf;

// BrdfParameters are coordinates on the axes of a family's table.
struct BrdfParameters {
  float roughness = 1.0f;  // perceptual, 0..1; alpha = roughness²
  float strength = 0.0f;   // of anisotropy, 0..1
};

// A BrdfFocus tells integration where a BRDF sends light towards a view: a share of its directions follows
// the cosine, the others a GGX distribution of half vectors about as narrow as the highlight. A bad choice
// costs accuracy, never correctness.
struct BrdfFocus {
  double alpha_t = 1.0, alpha_b = 1.0;
  double cosine_share = 0.5;
};

class Brdf {
 public:
  virtual ~Brdf() = default;
  virtual std::uint32_t lobes() const = 0;  // 2: F0 and F90 parts; 3: red, green, blue
  virtual bool isotropic() const = 0;
  virtual bool hasRoughness() const = 0;
  virtual BrdfFocus focus(const BrdfParameters& at) const = 0;
  // Computes f of each lobe, without the cosine. v and s are unit and both have z > 0. Values must be finite
  // and reciprocal; anisotropic BRDFs must be symmetric about the planes x = 0 and y = 0.
  virtual void value(const BrdfParameters& at, const glm::dvec3& v, const glm::dvec3& s,
                     std::span<double> out) const = 0;
};

std::unique_ptr<Brdf> makeGgx(bool anisotropic);
// Makes a BRDF from a measurement as import read it. Values are interpolated between measured directions, and
// scaled down where the BRDF would reflect more than it receives. Errors name the file: too few directions.
Result<std::unique_ptr<Brdf>> makeMeasured(const MeasuredBrdf& measured);

// Integrates b of one view, in the frame of the view: out[lobe * order² + k]. Uses so many directions, spread
// evenly over what `focus` says.
void integrateView(const Brdf& brdf, const BrdfParameters& at, const bundle::BrdfView& view, int order,
                   std::size_t directions, std::span<double> out);

// A BrdfGrid has the number of nodes along each axis of a table; docs/design/glossy.md, "Shading per
// pixel", lists their cost and error.
struct BrdfGrid {
  std::uint32_t angles = 2, azimuths = 1, roughnesses = 1, strengths = 1;
};
// Returns the grid for tables of which `order` bands are shipped.
BrdfGrid gridFor(const Brdf& brdf, int order);

// Integrates b(v) over the whole grid, within 0.1 % however narrow the lobe is, with `order` bands, 1..9.
// Runs on all threads, and the result does not depend on their number.
bundle::BrdfTable integrateTable(const Brdf& brdf, int order);
bundle::BrdfTable integrateTable(const Brdf& brdf, int order, const BrdfGrid& grid);

// Lists the BRDFs, and says which materials use which. Materials of one kind that name the same measurement,
// or none, share a table of b(v). A GGX table serves every material of its family, with closed forms on the
// GPU beside it. Any other BRDF is one function of the whole material in red, green and blue: it gets a table
// of family Measured, with which the runtime shades without knowing what it holds. To add one, derive a class
// from Brdf in a file of its own and add a row to the list.

struct BrdfKind {
  const char* name;  // an adjective, shown in plans
  bundle::BrdfFamily family;
  bool (*serves)(const gltf::Material&);  // is asked only of materials that are not matte
  Result<std::unique_ptr<Brdf>> (*make)(const Scene&, const gltf::Material&);
};

std::span<const BrdfKind> brdfKinds();

// Returns the first entry of the list that serves the material, which must not be matte.
const BrdfKind& brdfKindOf(const gltf::Material& material);

// Holds how much of uniform light the specular layer of a smooth dielectric reflects towards a view: its
// directional albedo, 0..1, in the channel where that is largest. The layer is as rough as the material's
// factor says, without textures. Allocates nothing.

class LayerAlbedo {
 public:
  LayerAlbedo() = default;  // reflects nothing
  // `table` is that of isotropic GGX.
  LayerAlbedo(const bundle::BrdfTable& table, const gltf::Material& material);

  // Returns the albedo towards a view at an angle to the normal with this cosine.
  float towards(float cosine) const;

 private:
  static constexpr std::size_t kCosines = 65;  // evenly from 0 to 1
  std::array<float, kCosines> albedos_{};
};

}  // namespace lambent::baker
