// One interface for everything that reflects: values of f for given directions in the local frame (z the normal, x the
// tangent), parted into lobes as runtime/bundle/brdf_table.hpp has them. A new BRDF (sheen, clearcoat) is one file with
// a class of this kind and a line in brdf_tables.cpp. No scene, no textures, no rays.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/measured_brdf.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/brdf_table.hpp"

namespace lambent::baker {

// Where on the axes of a family's table.
struct BrdfParameters {
  float roughness = 1.0f;  // perceptual, 0..1; alpha = roughness²
  float strength = 0.0f;   // of anisotropy, 0..1
};

class Brdf {
 public:
  virtual ~Brdf() = default;
  virtual std::uint32_t lobes() const = 0;  // 2: F0 and F90 parts; 3: RGB
  virtual bool isotropic() const = 0;
  virtual bool hasRoughness() const = 0;
  // f of each lobe, without the cosine; v and s unit, both with z > 0. Finite; reciprocal.
  virtual void value(const BrdfParameters& at, const glm::dvec3& v, const glm::dvec3& s,
                     std::span<double> out) const = 0;
};

std::unique_ptr<Brdf> makeGgx(bool anisotropic);
// The measurement as import read it; between measured directions interpolated, scaled down where it would reflect more
// than it receives.
std::unique_ptr<Brdf> makeMeasured(const MeasuredBrdf& measured);

// b(v) over the whole grid, by integration that follows the lobe however narrow it is; 0.1 % or better. Deterministic,
// on all threads.
bundle::BrdfTable integrateTable(const Brdf& brdf, int order);

}  // namespace lambent::baker
