// A BRDF table holds b(v), the radiance that a BRDF reflects towards v when the light is the basis function
// y_k (Kautz, Sloan and Snyder 2002):
//   b_k(v) = ∫ f(v, s) max(s_z, 0) y_k(s) ds,   reflected radiance r(v) = Σ_k b_k(v) l'_k
// where l' is the transferred light in the frame of the view: z is the normal, x lies in the surface on the
// side of the view (v = (sin theta_v, 0, cos theta_v)), and y = z cross x. In this frame b depends little on
// the view's azimuth. The table is a grid over view directions and, for families with parameters, over
// roughness and anisotropy; looking it up interpolates linearly between the nodes. sqrt(4 pi) b_0 is the
// directional albedo, at most 1 (for two lobes this holds for their sum). Nothing here needs a GPU.
//
// These are the axes of the grid:
//   angle:     cos(theta_v) = 1 - (1 - u²)² with u = i / (angles - 1). Nodes are dense towards grazing views,
//              where albedos change with cos(theta_v), and evenly spaced in theta_v near the normal, where
//              b_lm behaves like theta_v^m.
//   azimuth:   phi_v = j / (azimuths - 1) * pi/2 is the angle of the view about z from the tangent. The other
//              quadrants follow by reflection in tangent and bitangent, which flips the signs of m < 0. An
//              isotropic table has 1 node.
//   roughness: k / (roughnesses - 1) is glTF's perceptual roughness; a family without it has 1 node.
//   strength:  m / (strengths - 1) is KHR_materials_anisotropy's strength; a family without it has 1 node.
// Isotropic tables are symmetric about the xz plane, so coefficients with m < 0 are 0 and are not stored.
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
// Smallest cos(theta_v) for which b is defined; lower views are treated as this one.
inline constexpr float kLeastViewCosine = 1e-3f;

// Returns u, the position of a view on the axis "angle".
inline float angleAxis(float cos_theta) {
  const float past = std::sqrt(std::max(1.0f - cos_theta, 0.0f));
  return std::sqrt(std::max(1.0f - past, 0.0f));
}

struct BrdfTable {
  std::uint32_t order = 5;  // bands, 1..6
  // Two lobes are the parts that F0 and F90 multiply: r = F0 b^0 + F90 b^1 (Schlick 1994). Three are red,
  // green and blue.
  std::uint32_t lobes = 2;
  std::uint32_t angles = 2;  // at least 2
  std::uint32_t azimuths = 1, roughnesses = 1, strengths = 1;
  // [strength][roughness][azimuth][angle][lobe][coefficient]
  std::vector<float> values;

  bool isotropic() const { return azimuths == 1; }
  // Returns the number of stored coefficients per lobe. An isotropic table stores those with m >= 0, with
  // (l, m) at l(l+1)/2 + m; other tables store all.
  std::uint32_t coefficients() const { return isotropic() ? order * (order + 1) / 2 : order * order; }
  std::size_t nodeValues() const { return std::size_t{lobes} * coefficients(); }
  std::size_t nodes() const { return std::size_t{strengths} * roughnesses * azimuths * angles; }
};

// Describes a view direction in the terms of the table's axes.
struct BrdfView {
  float cos_theta = 1.0f;  // angle to the normal; values below 0 count as 0
  // Azimuth of the frame's x axis about the normal, from the tangent towards the bitangent. Isotropic tables
  // ignore it.
  float cos_phi = 1.0f, sin_phi = 0.0f;
};

// Writes all coefficients of b in the frame of the view to out[lobe * order² + k]. `roughness` and `strength`
// are clamped to 0..1.
void lookUp(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
            std::span<float> out);

// Writes only the stored coefficients, to out[lobe * coefficients() + c], as ZonalFactors::factor takes them.
void lookUpStored(const BrdfTable& table, const BrdfView& view, float roughness, float strength,
                  std::span<float> out);

// Encodes the payload "brdfTable" with 16 bits per value. The error is at most 1e-4 of the largest value of
// the same node and lobe.
std::vector<std::byte> encodeBrdfTable(const BrdfTable& table);
// Fails, naming `subject`, if sizes do not add up, values are not finite, or an albedo is negative or over 1.
Result<BrdfTable> decodeBrdfTable(std::span<const std::byte> bytes, const std::string& subject);

}  // namespace lambent::bundle
