// One interface for everything that reflects: values of f for given directions in the local frame (z the
// normal, x the tangent), parted into lobes as runtime/bundle/brdf_table.hpp has them. brdf_kinds.hpp lists
// them. No scene, no textures, no rays.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/brdf_table.hpp"

namespace lambent::baker {

struct MeasuredBrdf;

// Where on the axes of a family's table.
struct BrdfParameters {
  float roughness = 1.0f;  // perceptual, 0..1; alpha = roughness²
  float strength = 0.0f;   // of anisotropy, 0..1
};

// How integration finds what a BRDF sends towards a view: a share of its directions by the cosine, the others
// by a GGX distribution of half vectors about as narrow as the highlight. Bad advice costs accuracy, never
// correctness.
struct BrdfFocus {
  double alpha_t = 1.0, alpha_b = 1.0;
  double cosine_share = 0.5;
};

class Brdf {
 public:
  virtual ~Brdf() = default;
  virtual std::uint32_t lobes() const = 0;  // 2: F0 and F90 parts; 3: RGB
  virtual bool isotropic() const = 0;
  virtual bool hasRoughness() const = 0;
  virtual BrdfFocus focus(const BrdfParameters& at) const = 0;
  // f of each lobe, without the cosine; v and s unit, both with z > 0. Finite; reciprocal; not isotropic:
  // mirrors in x and in y.
  virtual void value(const BrdfParameters& at, const glm::dvec3& v, const glm::dvec3& s,
                     std::span<double> out) const = 0;
};

std::unique_ptr<Brdf> makeGgx(bool anisotropic);
// The measurement as import read it; between measured directions interpolated, scaled down where it would
// reflect more than it receives. Errors name the file: too few directions.
Result<std::unique_ptr<Brdf>> makeMeasured(const MeasuredBrdf& measured);

// b of one view: out[lobe * order² + k], in the frame of the view. By so many directions spread evenly over
// what `focus` says.
void integrateView(const Brdf& brdf, const BrdfParameters& at, const bundle::BrdfView& view, int order,
                   std::size_t directions, std::span<double> out);

// Nodes along each axis of a table; docs/measurements/glossy.md, "Tables of b(v)", has what they cost and
// leave.
struct BrdfGrid {
  std::uint32_t angles = 2, azimuths = 1, roughnesses = 1, strengths = 1;
};
// For tables of which `order` bands are shipped.
BrdfGrid gridFor(const Brdf& brdf, int order);

// b(v) over the whole grid, by integration that follows the lobe however narrow it is; 0.1 % or better.
// Deterministic, on all threads. order 1..9.
bundle::BrdfTable integrateTable(const Brdf& brdf, int order);
bundle::BrdfTable integrateTable(const Brdf& brdf, int order, const BrdfGrid& grid);

}  // namespace lambent::baker
