// b(v): what a BRDF sends towards direction v of light y_k, Kautz, Sloan and Snyder 2002:
//   b_k(v) = ∫ f(v, s) max(s_z, 0) y_k(s) ds,   reflected radiance r(v) = Σ_k b_k(v) l'_k
// with l' the transferred light in the frame of the view: z the normal, x along the surface towards where the
// view leans (v = (sin theta_v, 0, cos theta_v)), y = z cross x. In that frame b changes slowly with the
// view's azimuth, or not at all. Comes in: a grid over view directions and, for families with parameters,
// over roughness and anisotropy. Goes out: b at any place between. No GPU. sqrt(4 pi) b_0 is the directional
// albedo, at most 1 (of two lobes: their sum).
//
// Axes of the grid, each node to node with linear interpolation between:
//   angle:     cos(theta_v) = 1 - (1 - u²)², u = i / (angles - 1): dense towards grazing views, where albedos
//   change
//              with cos(theta_v), and even in theta_v about the normal, where b_lm goes like theta_v^m
//   azimuth:   phi_v = j / (azimuths - 1) * pi/2, of the view about z from the tangent; the other quadrants
//   by
//              reflection in tangent and bitangent, which turns the signs of m < 0. 1 node: isotropic
//   roughness: glTF's perceptual roughness k / (roughnesses - 1). 1 node: it has none
//   strength:  KHR_materials_anisotropy strength m / (strengths - 1). 1 node: none
// Isotropic tables are stored as such: they mirror in the xz plane, so only m >= 0 is not 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

inline constexpr std::uint32_t kMaxBrdfLobes = 3;
// Nodes with less cos(theta_v) are integrated at this; views at or below the horizon count as this one.
inline constexpr float kLeastViewCosine = 1e-3f;

// u of a view.
inline float angleAxis(float cos_theta) {
  const float past = std::sqrt(std::max(1.0f - cos_theta, 0.0f));
  return std::sqrt(std::max(1.0f - past, 0.0f));
}

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

// A view direction as the table's axes have it.
struct BrdfView {
  float cos_theta = 1.0f;  // to the normal; below 0 counts as 0
  // Azimuth of the frame's x axis about the normal, from the tangent towards the bitangent. Isotropic tables
  // do not ask.
  float cos_phi = 1.0f, sin_phi = 0.0f;
};

// b at a view and parameters: out[lobe * order² + k], all coefficients, in the frame of the view. roughness
// and strength are clamped to 0..1.
void lookUp(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
            std::span<float> out);

// The same without the coefficients that are always 0: out[lobe * coefficients() + c], as
// ZonalFactors::factor takes them.
void lookUpStored(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
                  std::span<float> out);

// Payload "brdfTable": 16 bits a value, within 1e-4 of the largest of its node and lobe.
std::vector<std::byte> encodeBrdfTable(const BrdfTable& table);
// Errors name `subject`: sizes that do not add up, values that are not finite, albedos that are negative or
// over 1.
Result<BrdfTable> decodeBrdfTable(std::span<const std::byte> bytes, const std::string& subject);

}  // namespace lambent::bundle
