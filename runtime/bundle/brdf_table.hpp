// b(v): what a BRDF sends towards direction v of light y_k, Kautz, Sloan and Snyder 2002:
//   b_k(v) = ∫ f(v, s) max(s_z, 0) y_k(s) ds,   reflected radiance r(v) = Σ_k b_k(v) l'_k
// with l' the transferred light in the local frame: z the normal, x the tangent. Comes in: a grid over view
// directions and, for families with parameters, over roughness and anisotropy. Goes out: b at any place
// between. No GPU. sqrt(4 pi) b_0 is the directional albedo, at most 1 (in each lobe: of its part).
//
// Axes of the grid, each node to node with linear interpolation between:
//   angle:     cos(theta_v) = u², u = i / (angles - 1): dense towards grazing views
//   azimuth:   phi_v = j / (azimuths - 1) * pi/2, of the view about z from the tangent; the other quadrants
//   by
//              reflection in x and y. 1 node: isotropic
//   roughness: glTF's perceptual roughness k / (roughnesses - 1). 1 node: it has none
//   strength:  KHR_materials_anisotropy strength m / (strengths - 1). 1 node: none
// Isotropic tables are stored as such: the view stands in the xz plane (x >= 0), where only m >= 0 is not 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

inline constexpr std::uint32_t kMaxBrdfLobes = 3;
// cos(theta_v) of the node u = 0, where the integral itself has no limit that any view comes to. Views at or
// below the horizon count as this one.
inline constexpr float kLeastViewCosine = 1e-3f;

struct BrdfTable {
  std::uint32_t order = 5;  // bands, 1..6
  // 2: the parts that F0 and F90 multiply: r = F0 b^0 + F90 b^1 (Schlick 1994). 3: red, green and blue.
  std::uint32_t lobes = 2;
  std::uint32_t angles = 2;  // at least 2
  std::uint32_t azimuths = 1, roughnesses = 1, strengths = 1;
  // [strength][roughness][azimuth][angle][lobe][coefficient]
  std::vector<float> values;

  bool isotropic() const { return azimuths == 1; }
  // Per lobe: of an isotropic table those with m >= 0, band by band, m rising: (l, m) at l(l+1)/2 + m. Else
  // all.
  std::uint32_t coefficients() const { return isotropic() ? order * (order + 1) / 2 : order * order; }
  std::size_t nodeValues() const { return std::size_t{lobes} * coefficients(); }
  std::size_t nodes() const { return std::size_t{strengths} * roughnesses * azimuths * angles; }
};

// A view direction as the table's axes have it: from the local, unit v with v.z clamped to >= 0.
struct BrdfView {
  float cos_theta = 1.0f;
  // Of the azimuth; (1, 0) for isotropic tables and at the pole.
  float cos_phi = 1.0f, sin_phi = 0.0f;
};

// b at a view and parameters: out[lobe * order² + k], all coefficients, in the local frame. For isotropic
// tables that frame has the view in the xz plane, x >= 0. roughness and strength are clamped to 0..1.
void lookUp(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
            std::span<float> out);

// The same without the coefficients that are always 0: out[lobe * coefficients() + c], as
// ZonalFactors::factor takes them.
void lookUpStored(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
                  std::span<float> out);

// Payload "brdfTable": 16 bits a value, of the largest of its node and lobe; so within 2e-5 of that.
std::vector<std::byte> encodeBrdfTable(const BrdfTable& table);
// Errors name `subject`: sizes that do not add up, values that are not finite, albedos that are negative or
// over 1.
Result<BrdfTable> decodeBrdfTable(std::span<const std::byte> bytes, const std::string& subject);

}  // namespace lambent::bundle
